//! What the study found, in words and two tables.

use armid::study::{Metric, ReportInput};

use crate::{Cell, Column, Section, Table};

/// How differences between criteria are tested, as every page says it.
pub(super) const TESTED: &str = "Intervals are 95 % t intervals of the mean difference of logarithms. The units are designs, in pairs if they share their start, by Welch if not; a criterion with one design has its runs as units. The interval of a log volume is by bootstrap over designs and runs. A difference is significant, and one criterion called better, if the p-value is below 0.05 after Holm's adjustment for all pairs of one score and estimator. That asks for more than an interval without the value of no difference.";

/// The values of every criterion, and every pairwise difference.
pub(super) fn section(input: &ReportInput) -> Section {
    let findings = input.result.findings();
    let columns = Column::list(
        "criterion | estimator | #designs | #runs | #failed | #prediction [N·m] | #prediction [of rating] | \
         #log volume | #parameters [ref. units] | #parameters [SI] | #measured torque [N·m] | #coverage [%]",
    );
    let mut values = Table::new(
        "What the designs of each criterion achieve; smaller is better. Prediction and parameter RMSE are geometric means over designs of those over runs. The log volume of the error, in reference units, needs more runs than parameters. Parameters in SI add unlike units as numbers, which is what a condition number bounds. Measured torque is that of fresh motions of the same arm, with effects and noise. Coverage is that of the stated 95 % intervals.",
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
        "Differences between criteria, first over second (log volume: first minus second), with 95 % intervals, what is repeated independently, the degrees of freedom of Student's t, and the p-value as Holm adjusts it.",
        Column::list(
            "metric | estimator | first | second | #difference | #low | #high | unit | #freedom | #adjusted p | \
             better",
        ),
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
        .text("Designs are ranked by the error that they achieve, not by the value of their criterion. The first score is the error of the torque that an estimate predicts on held-out random trajectories. No error is divided by a true value, which may be zero.")
        .table(values)
        .text(TESTED)
        .table(differences)
}
