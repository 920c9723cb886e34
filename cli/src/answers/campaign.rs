//! How a campaign stands, in words.

use std::fmt::Write;
use std::path::Path;

use armid::number::significant;
use armid_workflow::campaign::{CampaignAnswer, Outcome, Round, Width};

use super::findings::paragraph;
use crate::terminal::Table;

/// The answer on one screen.
pub(crate) fn campaign_text(answer: &CampaignAnswer) -> String {
    let Some(last) = answer.rounds.last() else { return format!("{}: no round is finished yet\n", answer.robot) };
    let rounds = answer.rounds.len();
    let after = format!(
        "after {rounds} round{}, {} s on the robot",
        if rounds == 1 { "" } else { "s" },
        significant(last.total_s, 4)
    );
    let verdict = match answer.outcome {
        Outcome::Reached => "every target is reached",
        Outcome::ModelError => {
            "NOT REACHABLE by these intervals: the bound on errors of the model is wider than a target"
        }
        Outcome::MostRounds => "not reached: the rounds are used up",
        Outcome::Unfinished => "not reached yet",
    };
    let mut text = format!("{}: {verdict} {after}\n\n", answer.robot);
    text.push_str(&targets(answer, &last.widths).render(2));
    for obstacle in &answer.obstacles {
        text.push('\n');
        text.push_str(&paragraph(&format!("{}: another round did not help. {}", obstacle.target, obstacle.effect), 2));
        text.push_str(&paragraph(&format!("→ {}", obstacle.advice), 4));
    }
    if !answer.added_terms.is_empty() {
        let _ = writeln!(text, "\n  added to the model, since the logs show them: {}", answer.added_terms.join(", "));
    }
    text.push('\n');
    text.push_str(&by_round(answer).render(2));
    let _ = writeln!(text, "  intervals are for 95 % over at most {} rounds together", answer.most_rounds);
    for (what, path) in [("estimate by all rounds", &answer.estimate), ("figure", &answer.figure)] {
        if let Some(path) = path {
            let _ = writeln!(text, "{what}: {}", path.display());
        }
    }
    text
}

/// What to do by hand.
pub(crate) fn round_text(round: &Round, folder: &Path) -> String {
    let points = round.folder.join("points.csv");
    format!(
        "next: perform {} ({} s), then `armid campaign {} --log FILE`\n",
        points.display(),
        significant(round.seconds, 4),
        folder.display()
    )
}

/// A row for each target.
fn targets(answer: &CampaignAnswer, widths: &[Width]) -> Table {
    let mut table = Table::of("target | #value | #± | #by errors of the model | reached");
    for (index, target) in answer.targets.iter().enumerate() {
        let (width, unit) = (&widths[index], &answer.units[index]);
        table.row([
            target.to_string(),
            format!("{} {unit}", significant(width.value, 4)),
            size(width.half_width, target.is_share, unit),
            size(width.by_model_error, target.is_share, unit),
            if answer.met[index] { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

/// A row for each round.
fn by_round(answer: &CampaignAnswer) -> Table {
    let mut headings = "round | #on the robot, s | #in all, s".to_owned();
    for target in &answer.targets {
        let _ = write!(headings, " | #{} ±", target.name());
    }
    let mut table = Table::of(&headings);
    for round in &answer.rounds {
        let times = [round.number.to_string(), significant(round.seconds, 4), significant(round.total_s, 4)];
        let widths = round.widths.iter().enumerate();
        let widths = widths.map(|(k, of)| size(of.half_width, answer.targets[k].is_share, &answer.units[k]));
        table.row(times.into_iter().chain(widths));
    }
    table
}

/// A half width with its unit.
fn size(value: f64, is_share: bool, unit: &str) -> String {
    match value {
        _ if !value.is_finite() => "not shown".to_owned(),
        _ if is_share => format!("{} %", significant(100.0 * value, 3)),
        _ => format!("{} {unit}", significant(value, 3)),
    }
}
