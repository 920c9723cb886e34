//! Criterion value against achieved error, and the spread of the error by criterion.

use armid::statistics::Spread;
use armid::study::{FamilyScore, ReportInput, StudyDesign, criterion_in_words};

use super::titles;
use crate::{
    Axis, BoxFigure, BoxRow, Distribution, DocumentError, Group, Heading, Quantiles, ScatterFigure, ScatterGroup,
    ScatterPanel, ScatterPoint, Section,
};

type Value = (&'static str, &'static str, fn(&StudyDesign) -> f64, bool);

/// Title, axis, value and whether the axis is logarithmic.
const VALUES: [Value; 3] = [
    ("Condition number", "condition number", |d| d.certificate.condition_all, true),
    ("Column-normalised", "normalised condition number", |d| d.certificate.condition_scaled_all, true),
    ("D-optimality", "ln det of the information per row", |d| d.certificate.log_det_information_all, false),
];

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let result = &input.result;
    let estimator = input.result.shown_estimator();
    let index = result.plan.identification.estimators.iter().position(|name| name == estimator).unwrap_or_default();
    let groups = Group::assign(result.plan.designs.iter().map(|family| criterion_in_words(&family.name)));
    let spread = &result.findings().design_prediction[index];
    let panels = VALUES
        .iter()
        .map(|(title, axis, value, log)| ScatterPanel {
            title: (*title).to_owned(),
            x: if *log { Axis::log(*axis, "") } else { Axis::linear(*axis, "") },
            y: Axis::log("prediction RMSE", "N·m"),
            groups: groups
                .iter()
                .enumerate()
                .map(|(family, group)| ScatterGroup {
                    label: group.label.clone(),
                    style: group.style,
                    points: result
                        .designs
                        .iter()
                        .zip(spread)
                        .filter(|(design, _)| design.family == family)
                        .filter_map(|(design, spread)| {
                            let spread = spread.as_ref()?;
                            let point = ScatterPoint::new(value(design), spread.median);
                            // One run has no quartiles.
                            let scatters = spread.lower_quartile < spread.upper_quartile;
                            let (low, high) = (spread.lower_quartile, spread.upper_quartile);
                            Some(if scatters { point.interval(low, high) } else { point })
                        })
                        .collect(),
                })
                .filter(|group| !group.points.is_empty())
                .collect(),
            references: Vec::new(),
        })
        .collect();
    let scatter = ScatterFigure {
        heading: Heading::new("criterion-and-error", titles::criterion_and_error(input).unwrap_or_else(|| "Criterion value and achieved error".to_owned()))
            .subtitle(format!("value of a design and its torque error: {} designs, estimator {estimator}", result.designs.len()))
            .caption("One point per design: median over its runs of the torque prediction RMSE on validation trajectories; bars reach from the lower to the upper quartile."),
        columns: 3,
        panels,
    };
    let prediction = boxes(
        input,
        &groups,
        Heading::new("error-by-criterion", finding(input).unwrap_or_else(|| "Torque prediction error".to_owned()))
            .subtitle("torque prediction error, all designs and runs of each criterion")
            .caption("RMSE on validation trajectories, all joints. Box: quartiles and median; whiskers: 5 % and 95 % quantiles over runs."),
        Axis::log("prediction RMSE", "N·m"),
        |family| family.prediction_spread,
    );
    let parameters = boxes(
        input,
        &groups,
        Heading::new("parameter-error-by-criterion", titles::parameters(input).unwrap_or_else(|| "Parameter error".to_owned()))
            .subtitle("parameter error, all designs and runs of each criterion, in the declared reference units")
            .caption("RMS over the base parameters of the error in reference units. Box: quartiles and median; whiskers: 5 % and 95 % quantiles over runs."),
        Axis::log("parameter RMSE", "reference units"),
        |family| family.reference_spread,
    );
    Section::new("Criteria and errors").figure(&prediction)?.figure(&parameters)?.figure(&scatter)
}

/// What the answer of the study says first of its criteria. Counts over several scenarios are not what the figure shows.
fn finding(input: &ReportInput) -> Option<String> {
    let plan = &input.result.plan;
    if plan.designs.len() < 2 || (input.result.conditions.len() > 1 && plan.compare_with.len() == 1) {
        return None;
    }
    let answer = input.result.answer();
    let bold = answer.first()?.split("**").nth(1)?;
    bold.strip_suffix('.').map(str::to_owned)
}

/// One box per criterion and estimator.
fn boxes(
    input: &ReportInput,
    groups: &[Group],
    heading: Heading,
    value: Axis,
    spread: fn(&FamilyScore) -> Option<Spread>,
) -> BoxFigure {
    let result = &input.result;
    let cell = |estimator: &str, name: &str| {
        let family = result.findings().families.iter().find(|f| f.estimator == estimator && f.family == name)?;
        let s = spread(family)?;
        let (q1, q3) = (s.lower_quartile, s.upper_quartile);
        Some(Distribution::from_quantiles(Quantiles { low: s.low, q1, median: s.median, q3, high: s.high }))
    };
    BoxFigure {
        heading,
        value,
        whiskers: "5 % to 95 %".to_owned(),
        groups: groups.to_vec(),
        rows: result
            .plan
            .identification
            .estimators
            .iter()
            .map(|name| BoxRow {
                label: name.clone(),
                cells: result.plan.designs.iter().map(|design| cell(name, &design.name)).collect(),
            })
            .collect(),
        levels: Vec::new(),
    }
}
