//! Everything that a frame shows, as values.

use armid::model::{EffortInterface, JointKind, Robot};
use armid_hardware::guard::{GuardSettings, GuardState, JointBounds};
use armid_hardware::monitor::Snapshot;

/// Everything that a frame shows.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// Name of the robot.
    pub(crate) robot: String,
    /// Where it is listened to.
    pub(crate) place: String,
    /// What was seen.
    pub(crate) snapshot: Snapshot,
    /// One row for each joint.
    pub(crate) joints: Vec<JointView>,
}

/// One joint, in the units that a person reads: degrees or millimetres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointView {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) position: Option<f64>,
    pub(crate) hard: (f64, f64),
    pub(crate) soft: (f64, f64),
    pub(crate) effort: Option<f64>,
    /// Largest effort that the guard allows for long; infinite where none is known.
    pub(crate) clamp: f64,
    pub(crate) effort_unit: &'static str,
}

impl View {
    /// A frame of what was seen of a robot whose guard has these settings.
    pub(crate) fn new(robot: &Robot, settings: &GuardSettings, place: &str, snapshot: &Snapshot) -> Self {
        let joint = |(j, (joint, bounds)): (usize, (&armid::model::Joint, JointBounds))| {
            let (unit, scale) = match joint.kind {
                JointKind::Revolute => ("°", 180.0 / std::f64::consts::PI),
                JointKind::Prismatic => ("mm", 1e3),
            };
            let pair = |(low, high): (f64, f64)| (scale * low, scale * high);
            JointView {
                name: bounds.name.clone(),
                unit,
                position: snapshot.row.as_ref().map(|row| scale * row.q[j]),
                hard: pair(bounds.hard),
                soft: pair(bounds.soft),
                effort: snapshot.row.as_ref().and_then(|row| row.effort.get(j).copied()),
                clamp: bounds.effort,
                effort_unit: match robot.effort() {
                    EffortInterface::Current => "A",
                    EffortInterface::Torque => joint.kind.effort_unit(),
                },
            }
        };
        let joints = robot.joints().iter().zip(JointBounds::of_robot(robot, settings)).enumerate().map(joint).collect();
        Self { robot: robot.name().to_owned(), place: place.to_owned(), snapshot: snapshot.clone(), joints }
    }

    /// What the guard says, where it still says something.
    pub(crate) fn guard(&self) -> Option<(&GuardState, f64)> {
        self.snapshot.guard.as_ref().map(|(state, age)| (state, *age))
    }
}
