//! What `armid study` says when it is done: who won by which metric, and where the report is.

use std::fmt::Write;

use armid::study::{Comparison, ConditionResult, FamilyScore, Metric, MotionKind, StudyResult, TruthComparison};
use armid_workflow::study::StudySummary;

use crate::terminal::{Answer, Table, number};

/// Rows of a table that still fit on one screen with the rest.
const SCREEN_ROWS: usize = 12;

/// The answer of a finished study; with more words every row and every metric.
pub(crate) fn answer(summary: &StudySummary, verbose: bool) -> Answer {
    let StudySummary { result, runs, failed, report, .. } = summary;
    let all = result.findings().families.len();
    let rows = if verbose { all } else { all.min(SCREEN_ROWS) };
    let mut text = format!("{}\n\n{}", result.plan.question, families(result, rows).render(0));
    let _ = write!(text, "\n{}", motions(result, rows).render(0));
    if rows < all {
        let _ = writeln!(text, "{} more rows in each table: the report, or `-v`", all - rows);
    }
    let _ = writeln!(
        text,
        "\n{runs} runs, {failed} failed. Smaller is better; geometric means over designs of those over runs."
    );
    if let ([part], true) = (result.conditions.as_slice(), *failed > 0) {
        let _ = writeln!(text, "How they ended: {}.", statuses(part));
    }
    let asked =
        Asked { result, estimator: result.plan.identification.estimators.last().map_or("", String::as_str), verbose };
    text += &asked.comparisons();
    text += &asked.over_arms();
    if let Some(found) = &result.radkhah2007 {
        let _ = writeln!(text);
        for claim in &found.claims {
            let _ = writeln!(text, "{:>14}  {}", claim.verdict.words(), claim.claim);
        }
    }
    if let Some(report) = report {
        let _ = writeln!(text, "\nreport: {}", report.display());
    }
    let json = serde_json::json!({
        "name": result.plan.name,
        "runs": runs,
        "failed": failed,
        "report": report.as_ref().map(|report| report.display().to_string()),
        "findings": result.findings(),
        "conditions": &result.conditions,
        "paper": &result.radkhah2007,
    });
    Answer { text, json }
}

/// How the runs under a condition ended.
fn statuses(part: &ConditionResult) -> String {
    let counts = part.statuses.iter().map(|count| format!("{} {}", count.runs, count.status));
    counts.collect::<Vec<_>>().join(", ")
}

/// Whether these are the two criteria of the question.
fn are_asked_about(families: [&str; 2]) -> bool {
    families.iter().all(|family| ["condition", "d-optimal"].contains(family))
}

/// The comparisons of the two criteria of the question.
struct Asked<'a> {
    result: &'a StudyResult,
    estimator: &'a str,
    verbose: bool,
}

impl Asked<'_> {
    /// Whether a metric is shown: every one of a single scenario, else that which decides.
    fn shows(&self, metric: Metric) -> bool {
        self.verbose || self.result.conditions.len() == 1 || metric == Metric::Prediction
    }

    /// Name of a row: the metric of a single scenario, else the scenario, with more words both.
    fn row(&self, part: &ConditionResult, metric: Metric) -> String {
        let metric = match metric.is_logarithmic() {
            true => format!("{} (difference)", metric.title()),
            false => metric.title().to_owned(),
        };
        match (self.result.conditions.len(), self.verbose) {
            (1, _) => metric,
            (_, true) => format!("{}: {metric}", part.condition.name),
            (_, false) => part.condition.name.clone(),
        }
    }

    /// A heading over those rows.
    fn heading(&self, first: &str, second: &str) -> String {
        let of = format!("{first} / {second}");
        if self.result.conditions.len() == 1 || self.verbose {
            of
        } else {
            format!("{}, {of}", Metric::Prediction.title())
        }
    }

    /// Rows under this heading, if there are any, no more than a screen has room for.
    fn table(&self, heading: &str, rows: Vec<Vec<String>>) -> String {
        if rows.is_empty() {
            return String::new();
        }
        let (all, mut table) = (rows.len(), Table::of(heading));
        let shown = if self.verbose { all } else { all.min(SCREEN_ROWS) };
        for row in rows.into_iter().take(shown) {
            table.row(row);
        }
        let more =
            if shown < all { format!("{} more rows: the report, or `-v`\n", all - shown) } else { String::new() };
        format!("\n{}{more}", table.render(0))
    }

    /// Over the units of each comparison.
    fn comparisons(&self) -> String {
        let (mut rows, mut heading) = (Vec::new(), String::new());
        for part in &self.result.conditions {
            let of_pair = |c: &&Comparison| {
                c.estimator == self.estimator && are_asked_about([&c.first, &c.second]) && self.shows(c.metric)
            };
            for c in part.findings.comparisons.iter().filter(of_pair) {
                heading = format!(
                    "{} | #ratio | #95 % interval | over | #adjusted p | better",
                    self.heading(&c.first, &c.second)
                );
                let mut row = vec![
                    self.row(part, c.metric),
                    number(c.difference),
                    c.interval.map_or_else(|| "–".to_owned(), |i| format!("{} to {}", number(i.low), number(i.high))),
                    c.unit.map_or("–", |unit| unit.words()).to_owned(),
                    c.p_adjusted.map_or_else(|| "–".to_owned(), number),
                    c.better.clone().unwrap_or_else(|| "not significant".to_owned()),
                ];
                if self.result.conditions.len() > 1 {
                    heading += " | ended";
                    row.push(statuses(part));
                }
                rows.push(row);
            }
        }
        self.table(&heading, rows)
    }

    /// Over arms that were drawn.
    fn over_arms(&self) -> String {
        let (mut rows, mut heading) = (Vec::new(), String::new());
        for part in &self.result.conditions {
            let of_pair = |c: &&TruthComparison| {
                c.estimator == self.estimator && are_asked_about([&c.first, &c.second]) && self.shows(c.metric)
            };
            for c in part.findings.over_truths.iter().filter(of_pair) {
                heading = format!(
                    "{} | #ratio over {} arms | #95 % interval | #least to greatest | #{} is better for",
                    self.heading(&c.first, &c.second),
                    c.truths,
                    c.first
                );
                rows.push(vec![
                    self.row(part, c.metric),
                    number(c.ratio),
                    c.interval.map_or_else(|| "–".to_owned(), |i| format!("{} to {}", number(i.low), number(i.high))),
                    format!("{} to {}", number(c.range.low), number(c.range.high)),
                    c.first_better.to_string(),
                ]);
            }
        }
        self.table(&heading, rows)
    }
}

fn families(result: &StudyResult, rows: usize) -> Table {
    let mut table = Table::of(
        "criterion | estimator | #designs | #runs | #prediction N·m | #of rating | #log volume | #reference | #SI | #measured N·m | #coverage %",
    );
    for family in result.findings().families.iter().take(rows) {
        let mut row =
            vec![family.family.clone(), family.estimator.clone(), family.designs.to_string(), family.runs.to_string()];
        row.extend(Metric::OF_ERRORS.iter().map(|&metric| value(family, metric)));
        row.push(format!("{:.1}", 100.0 * family.coverage));
        table.row(row);
    }
    table
}

/// Every criterion on each kind of motion.
fn motions(result: &StudyResult, rows: usize) -> Table {
    let kinds = MotionKind::ALL.map(MotionKind::title).join(" | #");
    let mut table = Table::of(&format!("prediction RMSE, N·m | estimator | #{kinds}"));
    for family in result.findings().families.iter().take(rows) {
        let mut row = vec![family.family.clone(), family.estimator.clone()];
        row.extend(Metric::OF_MOTIONS.iter().map(|&metric| value(family, metric)));
        table.row(row);
    }
    table
}

fn value(family: &FamilyScore, metric: Metric) -> String {
    family.value(metric).map_or_else(|| "–".to_owned(), number)
}
