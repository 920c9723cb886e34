//! What `armid run` answers: as a text and as JSON.

use std::fmt::Write;
use std::path::PathBuf;

use armid::experiment::{Ending, Phase, Tracking};
use armid::model::{EffortInterface, JointKind, Robot};
use armid_hardware::guard::{GuardRecord, Trip};
use serde_json::{Value, json};

use super::findings::paragraph;
use crate::arms::{Experiment, Performed, Speed};
use crate::terminal::{Answer, Table, number, stated};

/// An RMS error above this part of the range of a joint's command counts as not following it.
const NOT_FOLLOWED: f64 = 0.1;
/// Instants of a period at which the range is looked at.
const RANGE_SAMPLES: usize = 200;

/// The last step's answer; the ones before it are in `steps`.
pub(crate) fn answer(steps: &[Done]) -> Answer {
    let text: Vec<String> = steps.iter().map(Done::text).collect();
    let mut json = steps.last().map_or(Value::Null, Done::json);
    if steps.len() > 1 {
        json["steps"] = steps.iter().map(Done::json).collect();
    }
    Answer { text: text.join("\n"), json }
}

/// One experiment that was performed.
pub(crate) struct Done {
    pub(crate) experiment: Experiment,
    pub(crate) performed: Performed,
    pub(crate) samples: usize,
    pub(crate) written: PathBuf,
    pub(crate) speed: Speed,
}

impl Done {
    fn ending(&self) -> (&'static str, String) {
        let at = |t: f64, phase: Phase| format!("at t = {t:.3} s ({})", phase.name());
        match &self.performed.ending {
            Ending::Completed => ("completed", String::new()),
            Ending::Stopped { t, phase, rest } => ("stopped", format!("{}: {rest}", at(*t, *phase))),
            Ending::Diverged { t, phase, reason } => ("diverged", format!("{}: {reason}", at(*t, *phase))),
            Ending::Tripped { t, phase, trip } => ("tripped", format!("{}: {trip}", at(*t, *phase))),
        }
    }

    fn on_what(&self) -> String {
        let at = if self.speed == Speed::FULL { String::new() } else { format!(" at {} of the speed", self.speed) };
        format!("on arm {}{at}", self.experiment.arm.name())
    }

    /// Which guard tripped, why, and what it did; null where none did.
    fn trip(&self) -> Value {
        let Ending::Tripped { t, phase, trip } = &self.performed.ending else { return Value::Null };
        json!({
            "name": trip.trip,
            "reason": trip.reason,
            "action": trip.action.name(),
            "bound_ms": trip.bound_ms,
            "rest": trip.rest,
            "t_s": t,
            "phase": phase.name(),
        })
    }

    fn json(&self) -> Value {
        let plan = &self.experiment.planned.plan;
        let (ending, detail) = self.ending();
        json!({
            "recording": self.written,
            "robot": self.experiment.planned.robot.robot.name(),
            "arm": self.experiment.arm.name(),
            "seed": self.experiment.planned.seed,
            "run": self.experiment.planned.run,
            "ending": ending,
            "detail": detail,
            "trip": self.trip(),
            "rest": self.performed.ending.rest(),
            "speed": self.speed.part(),
            "guard": self.performed.guard,
            "stamps": self.performed.stamps,
            "samples": self.samples,
            "rate_hz": plan.rate_hz,
            "period_s": plan.trajectory.period_s(),
            "periods": plan.periods,
            "certificate": self.experiment.planned.certificate.as_ref().map(|certificate| json!({
                "trajectory_sha256": certificate.trajectory_sha256,
                "robot_sha256": certificate.robot_sha256,
                "worst_limit_use": certificate.worst_limit_use,
            })),
            "tracking": self.performed.tracking.as_ref().map(|tracking| json!({
                "peak_error": tracking.peak_error,
                "rms_error": tracking.rms_error,
                "error_units": self.experiment.planned.robot.robot.joints().iter().map(|j| j.kind.unit()).collect::<Vec<_>>(),
                "peak_effort": tracking.peak_effort,
                "effort_units": self.experiment.planned.robot.robot.joints().iter().map(|j| j.kind.effort_unit()).collect::<Vec<_>>(),
                "peak_current_a": tracking.peak_current,
                "saturated_steps": tracking.saturated_steps,
                "not_followed": not_followed(&self.experiment, tracking),
            })),
        })
    }

    fn text(&self) -> String {
        let plan = &self.experiment.planned.plan;
        let (ending, detail) = self.ending();
        let mut text = format!(
            "{}: {} {}, {} samples at {} Hz, {} recorded periods of {} s\n{}\n",
            self.experiment.planned.name,
            ending,
            if detail.is_empty() { self.on_what() } else { detail },
            self.samples,
            plan.rate_hz,
            plan.periods,
            stated(plan.trajectory.period_s()),
            self.written.display(),
        );
        if let Some(tracking) = &self.performed.tracking {
            let _ = write!(text, "\n{}", followed(&self.experiment.planned.robot.robot, tracking).render(2));
            for joint in not_followed(&self.experiment, tracking) {
                let sentence = format!(
                    "{joint} did not follow: its error is more than a tenth of its motion. A slower motion may be followed, or a \
                     servo of another [servo] in the robot file"
                );
                text.push('\n');
                text.push_str(&paragraph(&sentence, 2));
            }
            if tracking.saturated_steps > 0 {
                let _ = writeln!(text, "\n  a current was at its limit in {} servo steps", tracking.saturated_steps);
            }
        }
        if let Some(stamps) = self.performed.stamps.as_ref().filter(|stamps| !stamps.is_clean()) {
            let _ = writeln!(
                text,
                "\n  {} messages: {} lost in {} gaps (longest {:.1} ms), {} twice, {} out of order, {} samples missing",
                stamps.messages,
                stamps.lost,
                stamps.gaps,
                1e3 * stamps.longest_gap_s,
                stamps.duplicates,
                stamps.reordered,
                stamps.missing.len(),
            );
        }
        if let Some(guard) = &self.performed.guard {
            let _ = write!(text, "\n{}", watched(guard).render(2));
        }
        text
    }
}

/// How close each check of the guard came to its limit.
fn watched(guard: &GuardRecord) -> Table {
    let mut table = Table::of("guard | #used | #trips within");
    for trip in Trip::ALL {
        let Some(used) = guard.used.get(trip.name()) else { continue };
        let bound = trip.bound_ms(&guard.settings, guard.rate_hz);
        table.row([trip.name().to_owned(), format!("{:.0} %", 100.0 * used), format!("{bound:.0} ms")]);
    }
    table
}

/// Names of joints whose RMS error is more than [`NOT_FOLLOWED`] of the range of their command.
fn not_followed(experiment: &Experiment, tracking: &Tracking) -> Vec<String> {
    let states = experiment.planned.plan.trajectory.sample(RANGE_SAMPLES);
    let joints = experiment.planned.robot.robot.joints().iter().zip(&tracking.rms_error).enumerate();
    joints
        .filter(|(i, (_, error))| {
            let column = || states.q.iter().skip(*i).step_by(states.dof).copied();
            let range = column().fold(f64::NEG_INFINITY, f64::max) - column().fold(f64::INFINITY, f64::min);
            **error > NOT_FOLLOWED * range
        })
        .map(|(_, (joint, _))| joint.name.clone())
        .collect()
}

/// How the servo followed while it counted; motor currents of a robot that reports them.
fn followed(robot: &Robot, tracking: &Tracking) -> Table {
    let currents = robot.effort() == EffortInterface::Current;
    let more = if currents { " | #current peak | #of limit" } else { "" };
    let mut table = Table::of(&format!("joint | #error RMS | #peak | #effort peak | #of rating{more}"));
    for (i, joint) in robot.joints().iter().enumerate() {
        let error = |value: f64| match joint.kind {
            JointKind::Revolute => format!("{} mdeg", number(1e3 * value.to_degrees())),
            JointKind::Prismatic => format!("{} µm", number(1e6 * value)),
        };
        let share = |value: f64, limit: f64| {
            if limit.is_finite() { format!("{:.0} %", 100.0 * value / limit) } else { String::new() }
        };
        let mut cells = vec![
            joint.name.clone(),
            error(tracking.rms_error[i]),
            error(tracking.peak_error[i]),
            format!("{} {}", number(tracking.peak_effort[i]), joint.kind.effort_unit()),
            share(tracking.peak_effort[i], joint.limits.torque),
        ];
        if currents {
            let peak = tracking.peak_current[i];
            cells.extend([format!("{} A", number(peak)), share(peak, joint.drive.current_limit)]);
        }
        table.row(cells);
    }
    table
}
