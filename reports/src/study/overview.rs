//! What the study found, in words and two tables.

use armid::study::{Comparison, Metric, ReportInput};

use crate::{Cell, Column, Section, Table};

/// How differences between families are tested, as every page says it.
pub(super) const TESTED: &str = "Intervals are 95 % t intervals of the mean difference of logarithms: over designs that share their start in pairs, else Welch's over the designs of either family; runs count as units of a family with one design alone. A log volume's is by bootstrap over designs and runs. A family is called better where the p-value, adjusted by Holm's method for all pairs of one metric and estimator, is below 0.05, which asks for more than that an interval leaves out no difference.";
/// One comparison as a sentence.
pub(super) fn sentence(c: &Comparison) -> String {
    let unit = c.unit.map_or_else(String::new, |unit| format!(" over {}", unit.words()));
    let interval =
        c.interval.map_or_else(String::new, |i| format!(" (95 % interval{unit} {:.3} to {:.3})", i.low, i.high));
    let relation = if c.metric.is_logarithmic() {
        format!("{} minus {}", c.first, c.second)
    } else {
        format!("{} over {}", c.first, c.second)
    };
    let verdict =
        c.better.as_ref().map_or_else(|| "no difference shown".to_owned(), |better| format!("{better} is better"));
    format!("By {}: {relation} is {:.3}{interval}, {verdict}.", c.metric.title(), c.difference)
}

/// The values of every family, and every pairwise difference.
pub(super) fn section(input: &ReportInput) -> Section {
    let findings = input.result.findings();
    let columns = vec![
        Column::text("family"),
        Column::text("estimator"),
        Column::number("designs", ""),
        Column::number("runs", ""),
        Column::number("failed", ""),
        Column::number("prediction", "N·m"),
        Column::number("prediction", "of rating"),
        Column::number("log volume", ""),
        Column::number("parameters", "ref. units"),
        Column::number("parameters", "SI"),
        Column::number("measured torque", "N·m"),
        Column::number("coverage", "%"),
    ];
    let mut values = Table::new(
        "What each family of designs achieves; smaller is better. Torque prediction RMSE and parameter RMSE are geometric means over designs of those over runs; the log volume of the error in reference units needs more runs than parameters; parameters in SI add unlike units as numbers, which is what a condition number bounds; measured torque is that of fresh motions of the same arm, effects and noise included, where the plan asks for them; coverage is that of the stated 95 % intervals.",
        columns,
    );
    for family in &findings.families {
        let mut row = vec![
            Cell::text(&family.family),
            Cell::text(&family.estimator),
            Cell::count(family.designs),
            Cell::count(family.runs),
            Cell::count(family.failures),
        ];
        // The motions of other kinds have a table of their own.
        row.extend(
            Metric::OF_ERRORS
                .iter()
                .map(|&metric| family.value(metric))
                .map(|value| value.map_or(Cell::Missing, |value| Cell::number(value, 3))),
        );
        row.push(Cell::fixed(100.0 * family.coverage, 1));
        values = values.row(row);
    }
    let mut differences = Table::new(
        "Differences between families, first over second (log volume: first minus second), with 95 % intervals, what is repeated independently, the degrees of freedom of Student's t, and the p-value as Holm adjusts it.",
        vec![
            Column::text("metric"),
            Column::text("estimator"),
            Column::text("first"),
            Column::text("second"),
            Column::number("difference", ""),
            Column::number("low", ""),
            Column::number("high", ""),
            Column::text("unit"),
            Column::number("freedom", ""),
            Column::number("adjusted p", ""),
            Column::text("better"),
        ],
    );
    for c in &findings.comparisons {
        differences = differences.row(vec![
            Cell::text(c.metric.title()),
            Cell::text(&c.estimator),
            Cell::text(&c.first),
            Cell::text(&c.second),
            Cell::fixed(c.difference, 3),
            c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.low, 3)),
            c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.high, 3)),
            c.unit.map_or(Cell::Missing, |unit| Cell::text(unit.words())),
            c.degrees_of_freedom.map_or(Cell::Missing, |freedom| Cell::fixed(freedom, 1)),
            c.p_adjusted.map_or(Cell::Missing, |p| Cell::number(p, 2)),
            c.better.as_ref().map_or(Cell::Missing, Cell::text),
        ]);
    }
    Section::new("What was found")
        .text("Families are ranked by achieved error, never by their own criterion: first by the torque that an estimate predicts on held-out random trajectories, then by the volume of the parameter error, then by its size in declared units. Nothing is divided by a true value, which may be zero.")
        .table(values)
        .text(TESTED)
        .table(differences)
}
