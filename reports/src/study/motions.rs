//! Torque prediction on each kind of motion.

use armid::statistics::Interval;
use armid::study::{Comparison, Metric, MotionKind, ReportInput};

use crate::{Cell, Column, Section, Table};

/// Criteria by kinds of motion, and their ratios by kind.
pub(super) fn section(input: &ReportInput) -> Section {
    let (findings, estimator) = (input.result.findings(), input.result.shown_estimator());
    let kinds = |unit: &str| MotionKind::ALL.map(|kind| Column::number(kind.title(), unit));
    let mut columns = vec![Column::text("criterion")];
    columns.extend(kinds("N·m"));
    let mut values = Table::new(
        format!(
            "Torque prediction RMSE of each criterion by kind of motion, estimator {estimator}: geometric mean over designs with its 95 % t interval over designs (over runs of an only design)."
        ),
        columns,
    );
    for family in findings.families.iter().filter(|family| family.estimator == estimator) {
        let of = |metric: Metric| family.value(metric).map(|value| with_interval(value, family.interval(metric)));
        let cells = Metric::OF_MOTIONS.map(|metric| of(metric).map_or(Cell::Missing, Cell::text));
        values = values.row([vec![Cell::text(&family.family)], cells.to_vec()].concat());
    }
    let mut section = Section::new("By kind of motion")
        .text("All motions are inside the limits of position, speed and acceleration and inside the torque ratings by the nominal parameters, and no estimate is fitted to them. Random: Fourier series, as designs start from. Slow: the same at 30 % of their speed. Point to point: minimum jerk between random poses, at 90 % of what the limits allow. Static: random poses at rest, where gravity alone is predicted and friction, whose sign is open there, is left out.")
        .table(values);
    let pairs = compared(&findings.comparisons, estimator, &input.result.plan.compare_with);
    if !pairs.is_empty() {
        let mut columns = vec![Column::text("criterion"), Column::text("over")];
        columns.extend(kinds(""));
        let mut ratios = Table::new(
            "Error of one criterion over that of another by kind of motion, with 95 % intervals; below 1 the first predicts better.",
            columns,
        );
        for [family, over] in pairs {
            let of = |metric: Metric| {
                let of_metric = findings.comparisons.iter().filter(|c| c.estimator == estimator && c.metric == metric);
                let c = of_metric.filter_map(|c| c.over(over)).find(|c| c.first == family)?;
                Some(with_interval(c.difference, c.interval))
            };
            let cells = Metric::OF_MOTIONS.map(|metric| of(metric).map_or(Cell::Missing, Cell::text));
            ratios = ratios.row([vec![Cell::text(family), Cell::text(over)], cells.to_vec()].concat());
        }
        section = section.table(ratios);
    }
    section
}

/// The pairs whose ratios are shown: every family over the one that the plan compares with, or the first comparison of all.
fn compared<'a>(all: &'a [Comparison], estimator: &str, compare_with: &[String]) -> Vec<[&'a str; 2]> {
    let of_metric = all.iter().filter(|c| c.estimator == estimator && c.metric == Metric::Prediction);
    let pairs = of_metric.map(|c| [c.first.as_str(), c.second.as_str()]);
    match compare_with.first() {
        Some(reference) => pairs
            .filter(|pair| pair.contains(&reference.as_str()))
            .map(|[first, second]| if first == reference { [second, first] } else { [first, second] })
            .collect(),
        None => pairs.take(1).collect(),
    }
}

fn with_interval(value: f64, interval: Option<Interval>) -> String {
    let written = |value: f64| Cell::number(value, 3).written();
    let interval = interval.map_or_else(String::new, |i| format!(" [{}, {}]", written(i.low), written(i.high)));
    format!("{}{interval}", written(value))
}
