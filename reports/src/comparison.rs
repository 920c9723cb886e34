//! The page that sets two estimates side by side.

use armid::estimation::Comparison;
use armid::number::significant;

use crate::document::{Cell, Column, Table};
use crate::{
    Axis, Band, Bar, BarFigure, BarRow, Document, DocumentError, Group, Heading, Interval, IntervalFigure, IntervalRow,
    Level, Section,
};

/// How well an estimate predicted a held-out recording, n each.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// RMS difference of each joint, in the comparison's units.
    pub rms: Vec<f64>,
    /// RMS of the difference as a share of the measured effort's RMS.
    pub relative_rms: Vec<f64>,
}

/// What a comparison is shown with.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonInput {
    /// The two estimates side by side.
    pub comparison: Comparison,
    /// What they are called.
    pub labels: [String; 2],
    /// What each was made from, in words.
    pub origins: [String; 2],
    /// Names of the joints, n.
    pub joints: Vec<String>,
    /// Prediction of a validation recording, where there is one.
    pub predictions: [Option<Prediction>; 2],
}

/// The page of a comparison.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn.
pub fn comparison_document(input: &ComparisonInput) -> Result<Document, DocumentError> {
    let Comparison { parameters, beyond, rms_difference_std, .. } = &input.comparison;
    let [first, second] = &input.labels;
    let document = Document::new(format!("{}: {first} and {second}", input.comparison.robot))
        .subtitle(format!("{} base parameters, estimators {}", parameters.len(), input.comparison.estimators.join(" and ")))
        .summary(format!(
            "**{:.0} %** of the parameters differ by more than 1.96 standard deviations, where noise alone gives 5 %; \
             the differences have an RMS of **{rms_difference_std:.2}** standard deviations, where noise alone gives 1.",
            100.0 * beyond
        ))
        .section(differences(input)?)
        .section(residuals(input)?)
        .section(predictions(input)?)
        .section(values(input));
    let document = input
        .labels
        .iter()
        .zip(&input.origins)
        .fold(document, |document, (label, origin)| document.provenance(label.clone(), origin.clone()));
    Ok(document.provenance("armid", env!("CARGO_PKG_VERSION")))
}

fn differences(input: &ComparisonInput) -> Result<Section, DocumentError> {
    let rows = input.comparison.parameters.iter().map(|parameter| {
        let z = parameter.difference_std;
        IntervalRow { label: parameter.name.clone(), cells: vec![Some(Interval::new(z, z - 1.96, z + 1.96))] }
    });
    let (beyond, count) = (input.comparison.beyond, input.comparison.parameters.len());
    let apart = (beyond * count as f64).round();
    let title = format!("{apart} of {count} parameters differ by more than 1.96 standard deviations");
    let figure = IntervalFigure {
        heading: Heading::new("differences", title)
            .subtitle(format!("{} less {}", input.labels[1], input.labels[0]))
            .caption("Points: difference over the root of the summed variances. Bars: ± 1.96, which cover zero in 95 % of parameters where noise alone makes the difference."),
        value: Axis::linear("difference", "std"),
        groups: Group::assign(["difference"]),
        rows: rows.collect(),
        levels: vec![Level::new(0.0, "equal")],
        band: Some(Band::new(-1.96, 1.96, "95 % of what noise gives")),
    };
    Section::new("Differences").figure(&figure)
}

fn residuals(input: &ComparisonInput) -> Result<Section, DocumentError> {
    let rows = input.joints.iter().enumerate().map(|(j, joint)| BarRow {
        label: joint.clone(),
        bars: input.comparison.residual_rms.iter().map(|rms| Some(Bar { value: rms[j], interval: None })).collect(),
    });
    let unit = input.comparison.units.first().map_or("", String::as_str);
    let [first, second] = &input.comparison.residual_rms;
    let less = first.iter().zip(second).filter(|(first, second)| first < second).count();
    let title = format!("{} leaves less unexplained on {less} of {} joints", input.labels[0], first.len());
    let figure = BarFigure {
        heading: Heading::new("residuals", title).caption("Bars: RMS residual of each joint's equations."),
        value: Axis::linear("residual RMS", unit),
        groups: Group::assign(input.labels.clone()),
        rows: rows.collect(),
        levels: Vec::new(),
        digits: Some(4),
    };
    Section::new("Residuals").figure(&figure)
}

fn predictions(input: &ComparisonInput) -> Result<Section, DocumentError> {
    let section = Section::new("Prediction of a held-out recording");
    if input.predictions.iter().all(Option::is_none) {
        return Ok(section.text("There is no `validation.json` beside the estimates."));
    }
    let rows = input.joints.iter().enumerate().map(|(j, joint)| {
        let bar = |prediction: &Option<Prediction>| {
            prediction.as_ref().map(|p| Bar { value: 100.0 * p.relative_rms[j], interval: None })
        };
        BarRow { label: joint.clone(), bars: input.predictions.iter().map(bar).collect() }
    });
    let shares = input.predictions.iter().flatten().flat_map(|p| input.joints.iter().zip(&p.relative_rms));
    let worst = shares.max_by(|a, b| a.1.total_cmp(b.1));
    let title = worst.map_or_else(
        || "Error of the predicted effort".to_owned(),
        |(joint, share)| format!("At most {} % of a joint's effort is missed ({joint})", significant(100.0 * share, 2)),
    );
    let figure = BarFigure {
        heading: Heading::new("prediction", title)
            .caption("Bars: RMS of measured less predicted effort over the RMS of the measured."),
        value: Axis::linear("share of the measured RMS", "%"),
        groups: Group::assign(input.labels.clone()),
        rows: rows.collect(),
        levels: Vec::new(),
        digits: Some(2),
    };
    section.figure(&figure)
}

fn values(input: &ComparisonInput) -> Section {
    let columns = vec![
        Column::text("parameter"),
        Column::text("unit"),
        Column::number(input.labels[0].clone(), ""),
        Column::number("std", ""),
        Column::number(input.labels[1].clone(), ""),
        Column::number("std", ""),
        Column::number("difference", "std"),
    ];
    let table = input.comparison.parameters.iter().fold(Table::new("Both estimates", columns), |table, p| {
        table.row(vec![
            Cell::text(p.name.clone()),
            Cell::text(p.unit.clone()),
            Cell::number(p.value[0], 5),
            Cell::number(p.std[0], 2),
            Cell::number(p.value[1], 5),
            Cell::number(p.std[1], 2),
            Cell::fixed(p.difference_std, 2),
        ])
    });
    let section = Section::new("Values").table(table);
    let alone: Vec<String> = input
        .comparison
        .alone
        .iter()
        .zip(&input.labels)
        .filter(|(names, _)| !names.is_empty())
        .map(|(names, label)| format!("Only {label} has {}.", names.join(", ")))
        .collect();
    if alone.is_empty() { section } else { section.list(alone) }
}
