//! What `armid study` says when it is done: who won by which metric, and where the report is.

use std::fmt::Write;

use armid::study::{ConditionResult, FamilyScore, Findings, Metric, MotionKind, StudyResult};
use armid_workflow::study::StudySummary;

use crate::terminal::{Answer, Table, number};

/// The answer of a finished study.
pub(crate) fn answer(summary: &StudySummary) -> Answer {
    let StudySummary { result, runs, failed, report, .. } = summary;
    let mut text = format!("{}\n\n{}\n{}", result.plan.question, families(result).render(0), motions(result).render(0));
    let _ = writeln!(
        text,
        "\n{runs} runs, {failed} failed. Smaller is better; geometric means over designs of those over runs."
    );
    let estimator = result.plan.identification.estimators.last().map_or("", String::as_str);
    for part in &result.conditions {
        if result.conditions.len() > 1 {
            let _ = writeln!(text, "\n{}: {}", part.condition.name, statuses(part));
        } else if *failed > 0 {
            let _ = writeln!(text, "How they ended: {}.", statuses(part));
        }
        headline(&mut text, &part.findings, estimator);
        over_truths(&mut text, &part.findings, estimator);
    }
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

/// The two criteria of the question, by every metric.
fn headline(text: &mut String, findings: &Findings, estimator: &str) {
    for c in findings.comparisons.iter().filter(|c| c.estimator == estimator && are_asked_about([&c.first, &c.second]))
    {
        let sign = if c.metric.is_logarithmic() { "−" } else { "/" };
        let unit = c.unit.map_or_else(String::new, |unit| format!(" over {}", unit.words()));
        let interval = c.interval.map_or_else(String::new, |i| format!(" [{:.3}, {:.3}]{unit}", i.low, i.high));
        let p = c.p_adjusted.map_or_else(String::new, |p| format!(" (adjusted p {})", number(p)));
        let verdict =
            c.better.as_ref().map_or_else(|| "not significant".to_owned(), |better| format!("{better} is better"));
        let _ = writeln!(
            text,
            "{}, {} {sign} {}: {:.3}{interval}, {verdict}{p}",
            c.metric.title(),
            c.first,
            c.second,
            c.difference
        );
    }
}

/// The two criteria of the question over random truths.
fn over_truths(text: &mut String, findings: &Findings, estimator: &str) {
    for c in findings.over_truths.iter().filter(|c| c.estimator == estimator && are_asked_about([&c.first, &c.second]))
    {
        let interval = c.interval.map_or_else(String::new, |i| format!(" [{:.3}, {:.3}]", i.low, i.high));
        let _ = writeln!(
            text,
            "over {} truths, {}, {} / {}: {:.3}{interval}, from {:.3} to {:.3}; {} is better for {}",
            c.truths,
            c.metric.title(),
            c.first,
            c.second,
            c.ratio,
            c.range.low,
            c.range.high,
            c.first,
            c.first_better
        );
    }
}

fn families(result: &StudyResult) -> Table {
    let mut table = Table::of(
        "criterion | estimator | #designs | #runs | #prediction N·m | #of rating | #log volume | #reference | #SI | #measured N·m | #coverage %",
    );
    for family in &result.findings().families {
        let mut row =
            vec![family.family.clone(), family.estimator.clone(), family.designs.to_string(), family.runs.to_string()];
        row.extend(Metric::OF_ERRORS.iter().map(|&metric| value(family, metric)));
        row.push(format!("{:.1}", 100.0 * family.coverage));
        table.row(row);
    }
    table
}

/// Every criterion on each kind of motion.
fn motions(result: &StudyResult) -> Table {
    let kinds = MotionKind::ALL.map(MotionKind::title).join(" | #");
    let mut table = Table::of(&format!("prediction RMSE, N·m | estimator | #{kinds}"));
    for family in &result.findings().families {
        let mut row = vec![family.family.clone(), family.estimator.clone()];
        row.extend(Metric::OF_MOTIONS.iter().map(|&metric| value(family, metric)));
        table.row(row);
    }
    table
}

fn value(family: &FamilyScore, metric: Metric) -> String {
    family.value(metric).map_or_else(|| "–".to_owned(), short)
}

fn short(value: f64) -> String {
    if value.abs() >= 1e-3 { format!("{value:.4}") } else { number(value) }
}
