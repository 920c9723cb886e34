//! Which estimator: all of them on the same recordings, under every condition.

use armid::study::{ConditionResult, EstimatorComparison, Metric, ReportInput, criterion_in_words};

use super::titles;
use crate::{Axis, Cell, ColourMap, Column, DocumentError, Heading, HeatFigure, Section, Table};

/// Metrics by which estimators are shown beside each other, with the word of each.
const SHOWN: [(Metric, &str); 3] =
    [(Metric::Prediction, "prediction"), (Metric::Measured, "measured"), (Metric::Si, "parameters")];

/// The figures and the table; `None` of one estimator.
pub(super) fn section(input: &ReportInput) -> Result<Option<Section>, DocumentError> {
    let plan = &input.result.plan;
    let estimators = &plan.identification.estimators;
    // Of several families one is shown: the one that all are compared with, or the first.
    let Some(family) = plan.compare_with.first().or(plan.designs.first().map(|design| &design.name)) else {
        return Ok(None);
    };
    if estimators.len() < 2 {
        return Ok(None);
    }
    let mut section = Section::new("Estimators").text(format!(
        "Every estimator on the same recordings of the {} designs. An error over another is a geometric mean over runs in which both gave an estimate, with the 95 % t interval over designs, or over runs if there is one design.",
        criterion_in_words(family)
    ));
    for (metric, word) in SHOWN {
        if let Some(figure) = glance(input, family, metric, word) {
            section = section.figure(&figure)?;
        }
    }
    Ok(Some(section.table(table(input, family))))
}

/// The comparison of an estimator with the one that figures show.
fn compared<'a>(
    condition: &'a ConditionResult,
    family: &str,
    metric: Metric,
    estimator: &str,
) -> Option<&'a EstimatorComparison> {
    let of = |c: &&EstimatorComparison| c.family == family && c.metric == metric && c.estimator == estimator;
    condition.findings.estimator_comparisons.iter().find(of)
}

/// Error of each estimator over that of the best one, condition by condition; `None` where no arm was asked for the metric.
fn glance(input: &ReportInput, family: &str, metric: Metric, word: &str) -> Option<HeatFigure> {
    let estimators = &input.result.plan.identification.estimators;
    let (conditions, shown) = (&input.result.conditions, input.result.shown_estimator());
    let rows: Vec<Vec<Option<f64>>> = conditions
        .iter()
        .map(|condition| {
            let over_shown = estimators.iter().map(|estimator| {
                if estimator == shown {
                    return Some(1.0);
                }
                compared(condition, family, metric, estimator).map(|found| found.ratio)
            });
            over_shown.collect()
        })
        .collect();
    if rows.iter().all(|row| row.iter().flatten().count() < 2) {
        return None;
    }
    let over_best = |row: Vec<Option<f64>>| {
        let best = row.iter().copied().flatten().fold(f64::INFINITY, f64::min);
        row.into_iter().map(move |value| value.map(|value| value / best))
    };
    let rows: Vec<Vec<Option<f64>>> = rows.into_iter().map(|row| over_best(row).collect()).collect();
    let title = titles::estimators(estimators, &rows).unwrap_or_else(|| "Estimators".to_owned());
    Some(HeatFigure {
        heading: Heading::new(format!("estimators-{word}"), title)
            .subtitle(format!("{}: how many times the error of the best estimator in that scenario", metric.title()))
            .caption("Rows: scenarios. Columns: estimators, as the plan names them. 1 is the best; grey is one that gave no estimate."),
        rows: conditions.iter().map(|condition| condition.condition.name.clone()).collect(),
        columns: estimators.clone(),
        groups: Vec::new(),
        values: rows.into_iter().flatten().collect(),
        value: Axis::log("times the error of the best", "").including(&[1.0]),
        colours: ColourMap::Sequential,
        digits: 2,
    })
}

/// Every estimator against the one that figures show, with its coverage and how often it failed.
fn table(input: &ReportInput, family: &str) -> Table {
    let estimators = &input.result.plan.identification.estimators;
    let mut columns = vec![Column::text("scenario"), Column::text("estimator")];
    for (_, word) in SHOWN {
        columns.extend([Column::number(word, "ratio"), Column::number("low", ""), Column::number("high", "")]);
    }
    columns.extend([Column::number("coverage", "%"), Column::number("runs", ""), Column::number("failed", "")]);
    let caption = format!(
        "Estimators against {}: error over its error for torque prediction, torque measured on fresh motions, and parameters in SI units; how many parameters' stated 95 % intervals cover the true value; runs with an estimate, and without.",
        input.result.shown_estimator()
    );
    let number = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::number(value, 3));
    let mut table = Table::new(caption, columns);
    for condition in &input.result.conditions {
        for estimator in estimators {
            let mut row = vec![Cell::text(&condition.condition.name), Cell::text(estimator)];
            for (metric, _) in SHOWN {
                let found = compared(condition, family, metric, estimator);
                let interval = found.and_then(|found| found.interval);
                row.extend([
                    number(found.map(|found| found.ratio)),
                    number(interval.map(|interval| interval.low)),
                    number(interval.map(|interval| interval.high)),
                ]);
            }
            let score = condition.findings.families.iter().find(|s| s.family == family && s.estimator == *estimator);
            row.extend([
                number(score.filter(|score| score.runs > 0).map(|score| 100.0 * score.coverage)),
                score.map_or(Cell::Missing, |score| Cell::count(score.runs)),
                score.map_or(Cell::Missing, |score| Cell::count(score.failures)),
            ]);
            table = table.row(row);
        }
    }
    table
}
