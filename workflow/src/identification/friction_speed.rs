//! Speeds of laws of friction, with their joints and units.

use armid::estimation::{FrictionSpeed, FrictionSpeeds};
use armid::model::Robot;
use serde_json::{Value, json};

/// Names of the joints whose speed the data do not show.
pub fn hidden_speeds<'a>(speeds: &FrictionSpeeds, robot: &'a Robot) -> Vec<&'a str> {
    speeds.joints_not_shown().into_iter().map(|joint| robot.joints()[joint - 1].name.as_str()).collect()
}

/// The keys of the command's file.
pub(super) fn speeds_json(speeds: &FrictionSpeeds, robot: &Robot) -> Value {
    let joint = |of: &FrictionSpeed| {
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
        "not_shown": hidden_speeds(speeds, robot),
        "weighted_rms": { "stated": speeds.weighted_rms[0], "found": speeds.weighted_rms[1] },
        "held_out": speeds.held_out,
        "termination": speeds.termination,
    })
}
