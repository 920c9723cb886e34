//! What can stop a design before it starts.

use crate::base::BaseError;
use crate::model::{ColumnsError, RobotError};
use crate::trajectory::TrajectoryError;

/// Why a trajectory or a design problem cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// A trajectory cannot be as specified.
    #[error(transparent)]
    Motion(#[from] TrajectoryError),
    /// A trajectory file has a table `[certificate]` that is not a certificate.
    #[error("certificate: {message}")]
    Certificate {
        /// What was found and what was expected.
        message: String,
    },
    /// A trajectory moves another number of joints than the robot has.
    #[error("trajectory: number of joints is {found}, expected {expected}")]
    Joints {
        /// Joints of the trajectory.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// A trajectory has another period than the problem.
    #[error("trajectory: period is {found} s, expected {expected} s")]
    OtherPeriod {
        /// Period of the trajectory, s.
        found: f64,
        /// Period of the problem, s.
        expected: f64,
    },
    /// A setting that must be above zero is not.
    #[error("design: {quantity} is {found} {unit}, expected a finite number above zero")]
    NotPositive {
        /// Which setting.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A setting that must be finite is not.
    #[error("design: {quantity} is {found} {unit}, expected a finite number")]
    NotFinite {
        /// Which setting.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A setting that must not be below zero is.
    #[error("design: {quantity} is {found} {unit}, expected a finite number, zero or above")]
    Negative {
        /// Which setting.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A probability with which limits are held is none, or none that can be reached.
    #[error(
        "design: probability of keeping the limits of torque and current is {found}, expected 0.5 or more and less than 1"
    )]
    Confidence {
        /// What was found.
        found: f64,
    },
    /// A joint's number is beyond the last one.
    #[error("design: number of a joint is {found}, expected less than {joints}")]
    NoSuchJoint {
        /// Number of the joint, from 0.
        found: usize,
        /// Joints that there are.
        joints: usize,
    },
    /// A margin to the position limits leaves a joint nothing.
    #[error("design: the margin to the position limits gives {0}, expected one that leaves every joint a range")]
    PositionMargin(RobotError),
    /// A list has another length than the robot asks for.
    #[error("design: number of {quantity} is {found}, expected {expected}")]
    Length {
        /// What the list holds.
        quantity: &'static str,
        /// Its length.
        found: usize,
        /// What it must be.
        expected: usize,
    },
    /// There are too few of something.
    #[error("design: number of {quantity} is {found}, expected at least {least}")]
    TooFew {
        /// Of what.
        quantity: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        least: usize,
    },
    /// A joint that moves has too few harmonics for the family.
    #[error(
        "design: number of harmonics of joint \"{joint}\" is {found}, expected at least {least} for family {family}"
    )]
    TooFewHarmonics {
        /// Name of the joint.
        joint: String,
        /// Its harmonics.
        found: usize,
        /// What the family needs.
        least: usize,
        /// Name of the family.
        family: &'static str,
    },
    /// A joint is to stand still outside its range.
    #[error("design: frozen position of joint \"{joint}\" is {found}, expected within {} to {}", range.0, range.1)]
    FrozenOutside {
        /// Name of the joint.
        joint: String,
        /// Where it is to stand, rad (m).
        found: f64,
        /// Its range, rad (m).
        range: (f64, f64),
    },
    /// The prior information is not that of the base parameters.
    #[error("design: size of the prior information is {rows} × {columns}, expected {expected} × {expected}")]
    PriorSize {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Number of base parameters.
        expected: usize,
    },
    /// The base parameters could not be found.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// A column depends on more than is known.
    #[error(transparent)]
    Columns(#[from] ColumnsError),
    /// The robot's limits or drives are impossible.
    #[error(transparent)]
    Robot(#[from] RobotError),
}

/// A setting must be a finite number above zero.
pub(super) fn above_zero(quantity: &'static str, found: f64, unit: &'static str) -> Result<(), ExcitationError> {
    let holds = found.is_finite() && found > 0.0;
    if holds { Ok(()) } else { Err(ExcitationError::NotPositive { quantity, found, unit }) }
}

/// A list must have as many entries as the robot asks for.
pub(super) const fn same_length(quantity: &'static str, found: usize, expected: usize) -> Result<(), ExcitationError> {
    if found == expected { Ok(()) } else { Err(ExcitationError::Length { quantity, found, expected }) }
}
