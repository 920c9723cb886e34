//! Do criterion values predict the error? The rank correlation of a design's own values with its error in every score.

use armid::study::{CriterionCorrelation, DesignMethod, Metric, ReportInput, StudyPlan};

use crate::{Cell, Column, Section, Table};

/// The section on correlations; `None` of fewer designs than have any.
pub(super) fn section(input: &ReportInput) -> Option<Section> {
    let found = &input.result.findings().criterion_correlations;
    if found.iter().all(|correlation| correlation.rank_correlation.is_none()) {
        return None;
    }
    let section = Section::new("Do criterion values predict the error?").text(
        "Spearman's rank correlation over designs of each value with the median over a design's runs of each error, with its 95 % interval by Fisher's transform (standard error of Bonett and Wright, designs taken as independent). Every value is oriented so that smaller is better: a useful one has a correlation near 1.",
    );
    Some(section.text(caution(&input.result.plan)).table(matrix(found)))
}

/// What the choice of the designs does to the correlations.
fn caution(plan: &StudyPlan) -> &'static str {
    let is_unselected =
        |family: &armid::study::FamilyPlan| family.method == DesignMethod::Random && family.evaluations == 1;
    if plan.designs.iter().all(is_unselected) {
        "All designs are random and none was selected: the correlations are those of the value itself over such motions."
    } else {
        "The designs were selected: pooled designs that were each optimised for another criterion may turn a correlation's sign, and are no sample of motions in general."
    }
}

/// Rows: values and estimators; columns: metrics that an arm was asked for.
fn matrix(found: &[CriterionCorrelation]) -> Table {
    let metrics: Vec<Metric> =
        Metric::ALL.into_iter().filter(|&metric| found.iter().any(|c| c.metric == metric)).collect();
    let mut columns = vec![Column::text("value"), Column::text("estimator"), Column::number("designs", "")];
    columns.extend(metrics.iter().map(|metric| Column::text(metric.title())));
    let mut table = Table::new("Rank correlation of a design's own values with its errors, ρ [low, high].", columns);
    let mut rows: Vec<(&str, &str, usize)> = Vec::new();
    for c in found {
        if !rows.iter().any(|(value, estimator, _)| *value == c.value && *estimator == c.estimator) {
            rows.push((&c.value, &c.estimator, c.designs));
        }
    }
    for (value, estimator, designs) in rows {
        let mut row = vec![Cell::text(value), Cell::text(estimator), Cell::count(designs)];
        row.extend(metrics.iter().map(|&metric| {
            let of = |c: &&CriterionCorrelation| c.value == value && c.estimator == estimator && c.metric == metric;
            found.iter().find(of).map_or(Cell::Missing, entry)
        }));
        table = table.row(row);
    }
    table
}

/// `ρ [low, high]`, with signs as cells write them.
fn entry(c: &CriterionCorrelation) -> Cell {
    let Some(rho) = c.rank_correlation else { return Cell::Missing };
    let written = |value: f64| Cell::fixed(value, 2).written();
    let interval = c.interval.map_or_else(String::new, |i| format!(" [{}, {}]", written(i.low), written(i.high)));
    Cell::text(format!("{}{interval}", written(rho)))
}
