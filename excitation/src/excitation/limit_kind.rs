//! The kinds of limits that a motion is held against: their names, their units, and the part that a design may use.

use super::margins::Margins;
use crate::model::JointKind;

/// A kind of limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LimitKind {
    /// Range of a joint's position.
    Position,
    /// Speed of a joint.
    Velocity,
    /// Acceleration of a joint.
    Acceleration,
    /// Jerk of a joint.
    Jerk,
    /// Torque (force) of a joint.
    Torque,
    /// Root mean square of the torque (force) of a joint over a period.
    TorqueRms,
    /// Current of a motor.
    Current,
    /// Root mean square of the current of a motor over a period.
    CurrentRms,
    /// Distance between bodies.
    Clearance,
}

crate::input::named! { LimitKind {
    Position: "position", Velocity: "velocity", Acceleration: "acceleration", Jerk: "jerk", Torque: "torque",
    TorqueRms: "torque-rms", Current: "current", CurrentRms: "current-rms", Clearance: "clearance"
} }

impl LimitKind {
    /// Those that depend on the robot's parameters.
    pub const EFFORTS: [Self; 4] = [Self::Torque, Self::TorqueRms, Self::Current, Self::CurrentRms];

    /// Unit of its values for a joint of this kind.
    pub const fn unit(self, joint: JointKind) -> &'static str {
        match (self, joint) {
            (Self::Position, kind) => kind.unit(),
            (Self::Velocity, JointKind::Revolute) => "rad/s",
            (Self::Velocity, JointKind::Prismatic) => "m/s",
            (Self::Acceleration, JointKind::Revolute) => "rad/s²",
            (Self::Acceleration, JointKind::Prismatic) => "m/s²",
            (Self::Jerk, JointKind::Revolute) => "rad/s³",
            (Self::Jerk, JointKind::Prismatic) => "m/s³",
            (Self::Torque | Self::TorqueRms, kind) => kind.effort_unit(),
            (Self::Current | Self::CurrentRms, _) => "A",
            (Self::Clearance, _) => "m",
        }
    }

    /// Whether it is reached at one time, and not by a mean over the period.
    pub const fn has_time(self) -> bool {
        !matches!(self, Self::TorqueRms | Self::CurrentRms)
    }

    /// The part of the limit that a design may use. A clearance has none: it is kept whole.
    pub const fn permitted(self, margins: &Margins) -> f64 {
        match self {
            Self::Position => margins.position,
            Self::Velocity => margins.velocity,
            Self::Acceleration | Self::Jerk => margins.acceleration,
            Self::Torque | Self::TorqueRms | Self::Current | Self::CurrentRms => margins.torque,
            Self::Clearance => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_names_are_those_of_files_and_each_has_one() {
        for kind in LimitKind::ALL {
            assert_eq!(serde_json::to_string(&kind).unwrap(), format!("\"{}\"", kind.name()));
            assert_eq!(LimitKind::ALL.iter().filter(|other| other.name() == kind.name()).count(), 1);
        }
        assert_eq!(LimitKind::Jerk.unit(JointKind::Prismatic), "m/s³");
    }
}
