//! What a column of a log may be.

use super::Unit;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Time of the row.
    Time,
    /// Joint coordinates.
    Position,
    /// Measured joint velocities.
    Velocity,
    /// Motor currents.
    Current,
    /// Torques (forces).
    Torque,
    /// Joint coordinates behind the transmissions, where the positions are those of the motors.
    LinkPosition,
    /// Joint coordinates that position servos were commanded, whose known gains make torques of them.
    Command,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 7] =
        [Self::Time, Self::Position, Self::Velocity, Self::Current, Self::Torque, Self::LinkPosition, Self::Command];

    /// Whether its columns are those that torques come from.
    pub const fn is_effort(self) -> bool {
        matches!(self, Self::Current | Self::Torque | Self::Command)
    }

    /// Its key in a mapping.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::Position => "q",
            Self::Velocity => "qd",
            Self::Current => "current",
            Self::Torque => "tau",
            Self::LinkPosition => "q_link",
            Self::Command => "q_cmd",
        }
    }

    /// The units that it may be in; the first is taken where none is said.
    pub const fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => &[Unit::S, Unit::Ms, Unit::Us, Unit::Ns],
            Self::Position | Self::LinkPosition | Self::Command => {
                &[Unit::Rad, Unit::Deg, Unit::Mrad, Unit::Rev, Unit::M, Unit::Mm]
            }
            Self::Velocity => &[Unit::RadPerS, Unit::DegPerS, Unit::RevPerMin, Unit::MPerS, Unit::MmPerS],
            Self::Current => &[Unit::A, Unit::Ma, Unit::Percent],
            Self::Torque => &[Unit::Nm, Unit::MilliNm, Unit::N, Unit::Percent],
        }
    }

    /// Headings that mean it without a mapping, before the number of the joint. Commands have none: their gains must be stated.
    pub(crate) const fn names(self) -> &'static [&'static str] {
        match self {
            Self::Time => &["t", "time", "timestamp", "stamp"],
            Self::Position => &["q", "pos", "position", "joint_pos", "joint_position"],
            Self::Velocity => &["qd", "dq", "vel", "velocity", "joint_vel", "joint_velocity"],
            Self::Current => &["current", "cur", "joint_current", "motor_current"],
            Self::Torque => &["tau", "torque", "joint_torque"],
            Self::LinkPosition => &["q_link", "link_pos", "link_position"],
            Self::Command => &[],
        }
    }
}
