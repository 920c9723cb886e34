//! What a mapping leaves to be done to the values of a log until the robot is known.

use armid::model::EffortInterface;

use super::mapping::{ColumnMap, Quantity};
use crate::error::Error;

/// What is still to be done to the values of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Conversion {
    /// Positions are those of the motors.
    pub(super) q: Option<AtMotors>,
    /// Velocities are.
    pub(super) qd: Option<AtMotors>,
    /// Efforts are torques of the motors.
    pub(super) effort: Option<AtMotors>,
    /// What is added to the positions at the joints, rad (m), n; none where nothing is.
    pub(super) offset: Vec<f64>,
}

/// Values at the motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AtMotors {
    /// The gear ratios have been applied.
    Geared,
    /// They are the robot's.
    RobotsGear,
}

impl Conversion {
    /// What mappings leave to be done to values with their factors, and what the efforts are.
    ///
    /// # Errors
    /// [`Error`] where the offset is neither of one value nor of `n`.
    pub(super) fn of_maps(
        position: &ColumnMap,
        velocity: Option<&ColumnMap>,
        effort: &ColumnMap,
        n: usize,
    ) -> Result<(Self, EffortInterface), Error> {
        let at_motors = |map: &ColumnMap| match (&map.gear, map.motor) {
            (Some(_), _) => Some(AtMotors::Geared),
            (None, true) => Some(AtMotors::RobotsGear),
            (None, false) => None,
        };
        // A current with a constant is a torque of its motor.
        let with_constant = effort.constant.is_some();
        let is_torque = effort.quantity != Quantity::Current || with_constant;
        let conversion = Self {
            q: at_motors(position),
            qd: velocity.and_then(at_motors),
            effort: at_motors(effort).or(with_constant.then_some(AtMotors::RobotsGear)).filter(|_| is_torque),
            offset: position.offsets(n)?,
        };
        Ok((conversion, if is_torque { EffortInterface::Torque } else { EffortInterface::Current }))
    }
}
