//! Every criterion with every family of trajectories and number of harmonics, at a glance.

use armid::study::{FamilyPlan, FamilyScore, HarmonicsPlan, Metric, ReportInput, capitalised};

use super::selection::GROUPS;
use super::titles;
use crate::{Axis, Cell, ColourMap, Column, DocumentError, Figure, Heading, HeatFigure, Section, Table};

/// Whether a study is drawn as a grid: one with more families of designs than colours can show.
pub(super) fn is_grid(input: &ReportInput) -> bool {
    let designs = &input.result.plan.designs;
    designs.len() > GROUPS && designs.iter().all(|family| column(family).is_some())
}

/// The column of a family of designs: its trajectories, and their harmonics.
fn column(plan: &FamilyPlan) -> Option<(String, String)> {
    let harmonics = match plan.harmonics.as_ref()? {
        HarmonicsPlan::Every(harmonics) => harmonics.to_string(),
        HarmonicsPlan::Each(each) => each.iter().map(usize::to_string).collect::<Vec<_>>().join(","),
    };
    Some((plan.family.as_deref().unwrap_or("fourier").to_owned(), harmonics))
}

/// Neighbouring columns of the same trajectories.
fn groups(columns: &[(String, String)]) -> Vec<(String, usize)> {
    let mut groups: Vec<(String, usize)> = Vec::new();
    for (family, _) in columns {
        match groups.last_mut() {
            Some((last, count)) if last == family => *count += 1,
            _ => groups.push((family.clone(), 1)),
        }
    }
    groups
}

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let plan = &input.result.plan;
    let estimator = input.result.shown_estimator();
    let score = |family: &FamilyPlan| {
        let scores = input.result.findings().families.iter();
        scores.filter(|score| score.estimator == estimator).find(|score| score.family == family.name)
    };
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    for family in &plan.designs {
        let (Some(row), Some(column)) = (family.criterion.clone(), column(family)) else { continue };
        if !rows.contains(&row) {
            rows.push(row);
        }
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    // In thousandths, so that the digits that count fit into a cell; a volume is a logarithm already.
    let values = |metric: usize| -> Vec<Option<f64>> {
        let unit = if metric == 2 { 1.0 } else { 1e-3 };
        let mut values = Vec::new();
        for row in &rows {
            for name in &columns {
                let family = plan
                    .designs
                    .iter()
                    .find(|family| family.criterion.as_ref() == Some(row) && column(family).as_ref() == Some(name));
                values.push(family.and_then(score).and_then(|score| score.values[metric]).map(|value| value / unit));
            }
        }
        values
    };
    let evaluations = plan.designs.first().map_or(0, |family| family.evaluations);
    let starts = plan.designs.first().map_or(0, |family| family.starts);
    let figure = |name: &str, what: &str, metric: usize, value: Axis, digits: usize| {
        let headings: Vec<String> =
            columns.iter().map(|(family, harmonics)| format!("{family}, H = {harmonics}")).collect();
        let title = titles::least(&rows, &headings, &values(metric), what);
        HeatFigure {
        heading: Heading::new(name, title.unwrap_or_else(|| capitalised(what)))
            .subtitle(format!(
                "{what} by criterion and trajectories; {starts} starts of {evaluations} evaluations each, a gradient counting as one more; {estimator}"
            ))
            .caption(
                "Columns: number of harmonics H of each family of trajectories (splines: 2 H + 1 knots). Paler is better.",
            ),
        rows: rows.clone(),
        columns: columns.iter().map(|(_, harmonics)| harmonics.clone()).collect(),
        groups: groups(&columns),
        values: values(metric),
        value,
        colours: ColourMap::Sequential,
        digits,
    }
    };
    let figures: Vec<Box<dyn Figure>> = vec![
        Box::new(figure("prediction-by-design", "torque error", 0, Axis::log("prediction RMSE", "10⁻³ N·m"), 2)),
        Box::new(figure(
            "parameters-by-design",
            "parameter error",
            3,
            Axis::log("parameter RMSE", "10⁻³ reference units"),
            2,
        )),
        Box::new(figure("volume-by-design", "volume of the parameter error", 2, Axis::linear("log volume", ""), 0)),
    ];
    let mut section = Section::new("Criteria and trajectories");
    // A volume is not defined for fewer runs than parameters.
    let is_empty = |metric: usize| values(metric).iter().all(Option::is_none);
    for (figure, _) in figures.iter().zip([0, 3, 2]).filter(|(_, metric)| !is_empty(*metric)) {
        section = section.figure(&**figure)?;
    }
    let table = plan.designs.iter().filter_map(score).fold(
        Table::new(
            "Every combination: geometric means over designs, with 95 % t intervals over designs (over runs of an only design); smaller is better.",
            Column::list(
                "criterion, trajectories, harmonics | #designs | #runs | #prediction [N·m] | #low | #high | \
                 #parameters [ref. units] | #low | #high | #log volume",
            ),
        ),
        |table, score| table.row(row(score)),
    );
    Ok(section.table(table))
}

fn row(score: &FamilyScore) -> Vec<Cell> {
    let mut cells = vec![Cell::text(&score.family), Cell::count(score.designs), Cell::count(score.runs)];
    for metric in [Metric::Prediction, Metric::Reference] {
        let index = Metric::ALL.iter().position(|other| *other == metric).unwrap_or(0);
        cells.push(score.values[index].map_or(Cell::Missing, |value| Cell::number(value, 3)));
        let interval = score.intervals[index];
        cells.push(interval.map_or(Cell::Missing, |interval| Cell::number(interval.low, 3)));
        cells.push(interval.map_or(Cell::Missing, |interval| Cell::number(interval.high, 3)));
    }
    cells.push(score.values[2].map_or(Cell::Missing, |value| Cell::fixed(value, 1)));
    cells
}
