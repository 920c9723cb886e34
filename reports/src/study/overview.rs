//! What the study found, in words and two tables.

use armid::study::{Comparison, ReportInput};

use super::selection::shown_estimator;
use crate::{Cell, Column, Section, Table};

/// One sentence per deciding comparison, the first metric first.
pub(super) fn summary(input: &ReportInput) -> Vec<String> {
    let result = &input.result;
    let estimator = shown_estimator(input);
    let mut paragraphs = vec![format!("**{}**", result.plan.question)];
    let pair = input.result.findings().comparisons.iter().filter(|c| c.estimator == estimator);
    let headline: Vec<&Comparison> = pair
        .filter(|c| [&c.first, &c.second].iter().all(|f| ["condition", "d-optimal"].contains(&f.as_str())))
        .collect();
    if !headline.is_empty() {
        let sentences: Vec<String> = headline.iter().map(|c| sentence(c)).collect();
        paragraphs.push(sentences.join(" "));
        let winners: std::collections::BTreeSet<&str> = headline.iter().filter_map(|c| c.better.as_deref()).collect();
        paragraphs.push(match winners.len() {
            0 => "No metric shows a significant difference.".to_owned(),
            1 if headline.iter().all(|c| c.better.is_some()) => "The ranking is the same by every metric.".to_owned(),
            1 => "Where a metric decides, it decides the same way.".to_owned(),
            _ => "The metrics disagree: the ranking depends on the metric.".to_owned(),
        });
    }
    paragraphs
}

/// One comparison as a sentence.
pub(super) fn sentence(c: &Comparison) -> String {
    let interval = c.interval.map_or_else(String::new, |i| format!(" (95 % interval {:.3} to {:.3})", i.low, i.high));
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
        Column::number("coverage", "%"),
    ];
    let mut values = Table::new(
        "What each family of designs achieves; smaller is better. Torque prediction RMSE and parameter RMSE are geometric means over runs; the log volume of the error in reference units needs more runs than parameters; coverage is that of the stated 95 % intervals.",
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
        row.extend(family.values.iter().map(|value| value.map_or(Cell::Missing, |value| Cell::number(value, 3))));
        row.push(Cell::fixed(100.0 * family.coverage, 1));
        values = values.row(row);
    }
    let mut differences = Table::new(
        "Differences between families, first over second (log volume: first minus second), with 95 % intervals by bootstrap over designs and runs.",
        vec![
            Column::text("metric"),
            Column::text("estimator"),
            Column::text("first"),
            Column::text("second"),
            Column::number("difference", ""),
            Column::number("low", ""),
            Column::number("high", ""),
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
            c.better.as_ref().map_or(Cell::Missing, Cell::text),
        ]);
    }
    Section::new("What was found")
        .text("Families are ranked by achieved error, never by their own criterion: first by the torque that an estimate predicts on random trajectories that no design and no fit has seen, then by the volume of the parameter error, then by its size in declared units. Nothing is divided by a true value, which may be zero.")
        .table(values)
        .table(differences)
}
