//! What advice says, in words.

use std::fmt::Write;

use armid::number::significant;
use armid::statistics::Spread;
use armid::study::{AdvicePlan, Purpose};
use armid_workflow::advice::{AdviceAnswer, Candidate, Undetermined};

use crate::terminal::Table;

/// Parameters that are named one by one.
const NAMED: usize = 12;
/// Time beyond which nobody measures, min.
const MOST_MINUTES: f64 = 600.0;
/// Candidates in the table.
const SHOWN: usize = 12;

/// The answer on one screen.
pub(crate) fn advice_text(answer: &AdviceAnswer) -> String {
    let Some(best) = answer.candidates.first() else { return String::new() };
    let (measure, unit) = words(answer.purpose);
    let plain = AdvicePlan::columns_of(&best.estimator).1;
    let otherwise = if best.failed > 0 && plain != best.estimator {
        format!(", or {plain} where that fails")
    } else {
        String::new()
    };
    let mut text = format!(
        "{}: the motion \"{}\" for {} s, estimated by {}{otherwise}\n\n  expected {measure}: {}\n",
        answer.robot,
        best.design,
        significant(answer.duration_s, 4),
        best.estimator,
        expected(best, unit)
    );
    if let Some(longer) = &answer.longer {
        let [then, floor] = [longer.expected, longer.floor].map(|value| significant(value, 3));
        let _ = writeln!(text, "  an hour more would give: {then} {unit}; no time takes away {floor} {unit}");
    }
    let shown = answer.parameters - answer.poorly_determined.len();
    let _ = writeln!(
        text,
        "  it determines {shown} of {} base parameters to within a third of their value",
        answer.parameters
    );
    if !answer.poorly_determined.is_empty() {
        let named: Vec<String> = answer.poorly_determined.iter().take(NAMED).map(time_for).collect();
        let more = answer.poorly_determined.len() - named.len();
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        let _ = writeln!(text, "  not determined, with the minutes that would: {}{more}", named.join(", "));
    }
    let alike = answer.candidates.iter().filter(|other| other.is_like_the_best()).count();
    if alike > 0 {
        let _ = writeln!(
            text,
            "  {alike} of {} candidates cannot be told from it (interval contains 1)",
            answer.candidates.len()
        );
    }
    if !answer.limits_kept {
        text.push_str("  the motion exceeds a limit: the page shows which\n");
    }
    let _ = write!(
        text,
        "\n{measure}, {unit}, over {} runs on drawn arms with effects of {} drives\n",
        answer.runs,
        answer.drive.name()
    );
    text.push_str(&table(answer).render(2));
    if answer.candidates.len() > SHOWN {
        let _ = writeln!(text, "  and {} that are worse", answer.candidates.len() - SHOWN);
    }
    for taken in &answer.from_log {
        let _ = writeln!(text, "  from the log: {taken}");
    }
    for assumption in &answer.assumptions {
        let _ = writeln!(text, "  assumed: {assumption}");
    }
    if answer.failed > 0 {
        let _ = writeln!(text, "  {} of {} runs gave no estimate", answer.failed, answer.runs);
    }
    if let Some(report) = &answer.report {
        let _ = writeln!(text, "page: {}", report.display());
    }
    let _ = writeln!(text, "next: armid run {} -o log.mcap", answer.experiment.display());
    let _ = writeln!(text, "      armid identify log.mcap --estimator {plain} --columns {} -o E.json", best.columns);
    text
}

/// A parameter with the minutes that would determine it.
fn time_for(parameter: &Undetermined) -> String {
    let minutes = |time: f64| {
        if time < MOST_MINUTES { significant(time, 2) } else { format!("over {MOST_MINUTES}") }
    };
    let own = parameter.minutes.map_or_else(|| "never, being zero".to_owned(), minutes);
    match parameter.other.as_ref().filter(|(_, time)| *time < MOST_MINUTES) {
        Some((motion, time)) => format!("{} {own} ({} by \"{motion}\")", parameter.name, minutes(*time)),
        None => format!("{} {own}", parameter.name),
    }
}

/// A row for each candidate: over all levels, and at each.
fn table(answer: &AdviceAnswer) -> Table {
    let levels = answer.candidates.first().map_or(&[][..], |best| &best.by_level);
    let mut headings =
        "motion | estimator | #near the best | #expected | #5 % | #95 % | #over the first, 95 %".to_owned();
    if has_failed(answer) {
        headings.push_str(" | #failed runs");
    }
    for (level, _) in levels {
        let _ = write!(headings, " | #{level}");
    }
    let mut table = Table::of(&headings);
    for candidate in answer.candidates.iter().take(SHOWN) {
        table.row(row(candidate, levels, has_failed(answer)));
    }
    table
}

fn has_failed(answer: &AdviceAnswer) -> bool {
    answer.candidates.iter().any(|candidate| candidate.failed > 0)
}

fn row(candidate: &Candidate, levels: &[(String, Spread)], has_failed: bool) -> Vec<String> {
    let of = &candidate.error;
    let near = format!("{} %", significant(100.0 * candidate.near_best, 2));
    let mut cells = vec![candidate.design.clone(), candidate.estimator.clone(), near];
    cells.extend([candidate.expected, of.low, of.high].map(|value| significant(value, 3)));
    let ratio = candidate.over_best.map(|of| format!("{} to {}", significant(of.low, 3), significant(of.high, 3)));
    cells.push(ratio.unwrap_or_else(|| "–".to_owned()));
    cells.extend(has_failed.then(|| candidate.failed.to_string()));
    cells.extend(levels.iter().map(|(level, _)| {
        let found = candidate.by_level.iter().find(|(name, _)| name == level);
        found.map_or_else(|| "–".to_owned(), |(_, spread)| significant(spread.median, 3))
    }));
    cells
}

fn expected(candidate: &Candidate, unit: &str) -> String {
    let [expected, low, high] =
        [candidate.expected, candidate.error.low, candidate.error.high].map(|value| significant(value, 3));
    format!("{expected} {unit} (90 % of the simulated runs: {low} to {high})")
}

/// What decides, and its unit.
const fn words(purpose: Purpose) -> (&'static str, &'static str) {
    match purpose {
        Purpose::Torque => ("RMS error of measured torque on fast motions", "N·m"),
        Purpose::Simulation => ("RMS error of torque without effects, on fast motions", "N·m"),
        Purpose::PointToPoint => ("RMS error of measured torque from point to point", "N·m"),
        Purpose::Slow => ("RMS error of measured torque on slow motions", "N·m"),
        Purpose::Parameters => ("RMS error of the parameters", "reference units"),
        Purpose::Friction => ("RMS error of friction and offsets", "reference units"),
        Purpose::Payload => ("RMS error of a load's parameters", "reference units"),
    }
}
