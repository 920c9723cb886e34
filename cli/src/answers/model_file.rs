//! What is said of a model file, and of source code.

use std::fmt::Write;

use armid::estimation::BodyOrigin;
use armid::number::significant;
use armid_workflow::export::{ModelFile, ModelPrediction, Snapping, SourceFile};
use armid_workflow::numbers::{error_percent, number};

use super::findings::paragraph;

pub(crate) fn model_file_text(file: &ModelFile) -> String {
    let ModelPrediction { limit, good, .. } = &file.prediction;
    let mut text = format!("{}\n", file.prediction.sentence(&file.name));
    if !good {
        let failed = format!(
            "failed: the error on the log of the fit is more than {limit} times that of the estimate. The file is written; its bodies \
             and drives are fitted to the log with the terms of {}. `--to c` has every term of the estimate",
            file.to.name()
        );
        text += &paragraph(&failed, 2);
    }
    for lacking in &file.lacking {
        let _ = writeln!(
            text,
            "{} has no place for {}: with it the error is {}; it carries {} {} RMS of joint \"{}\", {} of its torque",
            file.to.name(),
            lacking.term,
            error_percent(lacking.error_with_it),
            number(lacking.torque_rms),
            lacking.unit,
            lacking.joint,
            error_percent(lacking.torque_share),
        );
    }
    if file.lacking.is_empty() && !file.left_out.is_empty() {
        let _ = writeln!(text, "{} has no place for {}", file.to.name(), file.left_out.join(", "));
    }
    let _ = writeln!(
        text,
        "the guess of the bodies weighs {}, the most that costs no significant error on blocks of the log (least error at {})",
        number(file.prior.taken),
        number(file.prior.least)
    );
    for (origin, what) in [(BodyOrigin::Shapes, "their shapes"), (BodyOrigin::Length, "the distance of their joints")] {
        let links = file.bodies.iter().zip(&file.joints).filter(|(found, _)| **found == origin);
        let links: Vec<String> = links.map(|(_, joint)| format!("\"{joint}\"")).collect();
        if !links.is_empty() {
            let _ = writeln!(
                text,
                "the robot file states no inertia for the links of {}: their guess is of uniform density, by {what}",
                links.join(", ")
            );
        }
    }
    if !file.termination.was_successful() {
        let _ = writeln!(text, "the fit {}", file.termination);
    }
    let _ = writeln!(
        text,
        "read back, its torque is that of the regressor to {} of the largest, over {} random states",
        number(file.reload.difference),
        file.reload.states
    );
    for remark in &file.remarks {
        let _ = writeln!(text, "{remark}");
    }
    text.extend(file.snapped.iter().map(snapping_text));
    text
}

fn snapping_text(Snapping { joints, largest_angle_rad, torque, .. }: &Snapping) -> String {
    let joints: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let most = torque.relative_rms.iter().copied().fold(0.0, f64::max);
    let sentence = format!(
        "angles of the URDF up to {} rad off right ones ({}) are taken as right: that changes at most {} % of a joint's torque",
        significant(*largest_angle_rad, 2),
        joints.join(", "),
        significant(100.0 * most, 2),
    );
    paragraph(&sentence, 0)
}

pub(crate) fn source_text(source: &SourceFile) -> String {
    let mut text = format!("{}: inverse dynamics of {} operations", source.robot, source.operations);
    let _ = writeln!(text, " in {} base parameters; gravity torque, mass matrix, regressor", source.base.len());
    text += match source.forward_dynamics {
        true => "and forward dynamics, where the mass matrix has an inverse\n",
        false => "no forward dynamics: friction depends on the load\n",
    };
    let _ = writeln!(
        text,
        "its torque is that of the regressor to {} of the largest, over {} random states",
        number(source.reload.largest_relative_difference),
        source.reload.states
    );
    for joint in &source.offset_in_gravity {
        let _ = writeln!(
            text,
            "the gravity torque of joint \"{joint}\" has its constant offset: no motion tells them apart"
        );
    }
    for remark in &source.remarks {
        let _ = writeln!(text, "{remark}");
    }
    text
}
