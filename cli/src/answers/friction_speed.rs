//! What `armid identify` answers of the speeds of laws of friction, beside its estimates.

use armid::estimation::{FrictionSpeed, FrictionSpeeds, HeldOutChange, Measured};
use armid::model::Robot;
use armid::number::significant;
use armid_workflow::identification::hidden_speeds;

use super::findings::paragraph;
use crate::terminal::{Table, number, stated};

fn name<'a>(robot: &'a Robot, of: &FrictionSpeed) -> &'a str {
    &robot.joints()[of.joint - 1].name
}

/// The change of the squared error in percent, with its interval, whose middle it is by logarithms.
pub(crate) fn change_text(change: &HeldOutChange) -> String {
    let [low, high] = change.change_ci95;
    let mean = ((1.0 + low) * (1.0 + high)).sqrt() - 1.0;
    format!("{:.1} % ({:.1} to {:.1})", 100.0 * mean, 100.0 * low, 100.0 * high)
}

/// Speeds in which Coulomb friction sets in, in a sentence.
pub(crate) fn onset_text(speeds: &FrictionSpeeds, robot: &Robot) -> String {
    let shown = |of: &FrictionSpeed| Some(format!("{} {}", name(robot, of), significant(of.speed?.value, 3)));
    let shown: Vec<String> = speeds.joints.iter().filter_map(shown).collect();
    if shown.is_empty() {
        return String::new();
    }
    let of_this = if speeds.predict_better() {
        "which the estimate takes"
    } else {
        "which predicts no better than the stated speeds"
    };
    let speeds = shown.join(", ");
    paragraph(&format!("Coulomb friction sets in over these speeds (rad/s, m/s), {of_this}: {speeds}"), 2)
}

/// The table, and what it means; `used` says whether the estimate has these speeds.
pub(crate) fn speeds_text(speeds: &FrictionSpeeds, robot: &Robot, used: bool) -> String {
    let is_onset = speeds.shape.smooths;
    let (title, amplitude) = match is_onset {
        true => ("speeds in which Coulomb friction sets in", "Coulomb friction"),
        false => ("speeds at which friction falls", "above Coulomb friction"),
    };
    let measured = "#95 % interval | # | ";
    let mut table = Table::of(&format!("joint | #stated | #speed | {measured} | #{amplitude} | {measured}"));
    for of in &speeds.joints {
        let kind = robot.joints()[of.joint - 1].kind;
        let three = |value: Option<Measured>| match value {
            Some(of) => [of.value, of.ci95[0], of.ci95[1]].map(|value| significant(value, 3)),
            None => ["not shown", "–", "–"].map(str::to_owned),
        };
        let mut row = vec![name(robot, of).to_owned(), stated(of.stated)];
        row.extend(three(of.speed));
        row.push(format!("{}/s", kind.unit()));
        row.extend(three(of.amplitude));
        row.push(kind.effort_unit().to_owned());
        table.row(row);
    }
    let [stated, found] = speeds.weighted_rms.map(number);
    let mut text = format!("{title}: {}\n{}", speeds.termination, table.render(2));
    let mut say = |sentence: String| text += &paragraph(&sentence, 2);
    say(format!("Weighted residual {found} with these speeds, {stated} with the stated ones."));
    if let Some(change) = &speeds.held_out {
        let change = change_text(change);
        say(format!("Squared error of each fifth of the log, predicted from the rest: {change}."));
    }
    say(match used {
        true => "The estimate has these speeds and takes them as exact. The intervals above hold their uncertainty."
            .to_owned(),
        false => {
            "The estimate has the stated speeds: with those found, torque that was not fitted is not predicted better."
                .to_owned()
        }
    });
    let not_shown = hidden_speeds(speeds, robot);
    if !not_shown.is_empty() {
        say(format!(
            "Not shown by this log, the stated speed stays (0: the sign of velocity): {}. `--reversal-fraction 0` keeps the rows in \
             which a joint is slow.",
            not_shown.join(", ")
        ));
    }
    text + "\n"
}
