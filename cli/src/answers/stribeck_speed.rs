//! What `armid identify --stribeck-speed` answers beside its estimates.

use std::fmt::Write;

use armid::estimation::{SpeedValue, StribeckSpeed, StribeckSpeeds};
use armid::model::Robot;
use armid::model::term::Stribeck;
use serde_json::{Value, json};

use super::findings::paragraph;
use crate::terminal::{Align, Table, number};

fn name<'a>(robot: &'a Robot, of: &StribeckSpeed) -> &'a str {
    &robot.joints()[of.joint - 1].name
}

/// Names of the joints whose speed the data do not decide.
fn undecided<'a>(speeds: &StribeckSpeeds, robot: &'a Robot) -> Vec<&'a str> {
    speeds.joints.iter().filter(|of| of.speed.is_none()).map(|of| name(robot, of)).collect()
}

/// The lines of the robot file that state the speeds that were found, each with its joint.
fn corrected(speeds: &StribeckSpeeds, robot: &Robot) -> String {
    let line = |(of, speed): (&StribeckSpeed, SpeedValue)| {
        let key = Stribeck::VELOCITY.key;
        format!("shape = {{ {key} = {:.6} }}  # joint \"{}\", was {}", speed.value, name(robot, of), of.stated)
    };
    let found = speeds.joints.iter().filter_map(|of| of.speed.map(|speed| (of, speed)));
    found.map(line).collect::<Vec<_>>().join("\n")
}

/// The keys.
pub(crate) fn speeds_json(speeds: &StribeckSpeeds, robot: &Robot) -> Value {
    let joint = |of: &StribeckSpeed| {
        let joint = &robot.joints()[of.joint - 1];
        json!({
            "joint": joint.name,
            "stated": of.stated,
            "speed": of.speed,
            "unit": format!("{}/s", joint.kind.unit()),
            "amplitude": of.amplitude,
            "amplitude_unit": joint.kind.effort_unit(),
        })
    };
    json!({
        "joints": speeds.joints.iter().map(joint).collect::<Vec<_>>(),
        "undecided": undecided(speeds, robot),
        "weighted_rms": { "stated": speeds.weighted_rms[0], "found": speeds.weighted_rms[1] },
        "termination": speeds.termination,
        "corrected": corrected(speeds, robot),
    })
}

/// The table, and what it means.
pub(crate) fn speeds_text(speeds: &StribeckSpeeds, robot: &Robot) -> String {
    let mut table = Table::new(&[
        ("joint", Align::Left),
        ("stated", Align::Right),
        ("Stribeck velocity", Align::Right),
        ("95 % interval", Align::Right),
        ("", Align::Right),
        ("", Align::Left),
        ("above Coulomb friction", Align::Right),
        ("95 % interval", Align::Right),
        ("", Align::Right),
        ("", Align::Left),
    ]);
    for of in &speeds.joints {
        let kind = robot.joints()[of.joint - 1].kind;
        let three = |value: Option<SpeedValue>| match value {
            Some(of) => [of.value, of.ci95[0], of.ci95[1]].map(number),
            None => ["undecided", "–", "–"].map(str::to_owned),
        };
        let mut row = vec![name(robot, of).to_owned(), number(of.stated)];
        row.extend(three(of.speed));
        row.push(format!("{}/s", kind.unit()));
        row.extend(three(of.amplitude));
        row.push(kind.effort_unit().to_owned());
        table.row(row);
    }
    let [stated, found] = speeds.weighted_rms.map(number);
    let mut text = format!("speeds at which friction falls: {}\n{}", speeds.termination, table.render(2));
    text += &paragraph(
        &format!(
            "Weighted residual {found} by these speeds, {stated} by those of the robot file. The intervals above hold the uncertainty of the \
             speed; those of the estimate below take it as exact."
        ),
        2,
    );
    let undecided = undecided(speeds, robot);
    if !undecided.is_empty() {
        text += &paragraph(
            &format!(
                "Not decided by these data, the speed of the robot file stays: {}. Their friction does not fall, or it does where a joint is \
                 slower than at any equation (`--reversal-fraction 0` keeps those).",
                undecided.join(", ")
            ),
            2,
        );
    }
    let corrected = corrected(speeds, robot);
    if !corrected.is_empty() {
        text += "→ in the table [joint.drive] of each joint in robot.toml, for commands that read this estimate:\n";
        for line in corrected.lines() {
            let _ = writeln!(text, "  {line}");
        }
    }
    text + "\n"
}
