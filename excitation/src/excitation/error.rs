//! What can stop a design before it starts.

use crate::base::BaseError;
use crate::model::{ColumnsError, RobotError};
use crate::trajectory::TrajectoryError;

/// Why a trajectory or a design problem cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ExcitationError {
    /// A trajectory cannot be as specified.
    #[error(transparent)]
    Motion(#[from] TrajectoryError),
    /// A trajectory file has a table `[certificate]` that is not a certificate.
    #[error("certificate: {message}")]
    Certificate { message: String },
    /// A trajectory moves another number of joints than the robot has.
    #[error("trajectory: number of joints is {found}, expected {expected}")]
    Joints { found: usize, expected: usize },
    /// A trajectory has another period than the problem.
    #[error("trajectory: period is {found} s, expected {expected} s")]
    OtherPeriod { found: f64, expected: f64 },
    /// A setting that must be above zero is not.
    #[error("design: {quantity} is {found} {unit}, expected a finite number above zero")]
    NotPositive { quantity: &'static str, found: f64, unit: &'static str },
    /// A setting that must be finite is not.
    #[error("design: {quantity} is {found} {unit}, expected a finite number")]
    NotFinite { quantity: &'static str, found: f64, unit: &'static str },
    /// A setting that must not be below zero is.
    #[error("design: {quantity} is {found} {unit}, expected a finite number, zero or above")]
    Negative { quantity: &'static str, found: f64, unit: &'static str },
    /// A probability with which limits are held is none, or none that can be reached.
    #[error(
        "design: probability of keeping the limits of torque and current is {found}, expected 0.5 or more and less than 1"
    )]
    Confidence { found: f64 },
    /// A margin to the position limits leaves a joint nothing.
    #[error("design: the margin to the position limits gives {0}, expected one that leaves every joint a range")]
    PositionMargin(RobotError),
    /// A list has another length than the robot asks for.
    #[error("design: number of {quantity} is {found}, expected {expected}")]
    Length { quantity: &'static str, found: usize, expected: usize },
    /// There are too few of something.
    #[error("design: number of {quantity} is {found}, expected at least {least}")]
    TooFew { quantity: &'static str, found: usize, least: usize },
    /// A joint that moves has too few harmonics for the family.
    #[error(
        "design: number of harmonics of joint \"{joint}\" is {found}, expected at least {least} for family {family}"
    )]
    TooFewHarmonics { joint: String, found: usize, least: usize, family: &'static str },
    /// A joint is to stand still outside its range.
    #[error("design: frozen position of joint \"{joint}\" is {found}, expected within {} to {}", range.0, range.1)]
    FrozenOutside { joint: String, found: f64, range: (f64, f64) },
    /// The prior information is not that of the base parameters.
    #[error("design: size of the prior information is {rows} × {columns}, expected {expected} × {expected}")]
    PriorSize { rows: usize, columns: usize, expected: usize },
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

/// A setting must be a finite number, zero or above.
pub(super) fn not_below_zero(quantity: &'static str, found: f64, unit: &'static str) -> Result<(), ExcitationError> {
    let holds = found.is_finite() && found >= 0.0;
    if holds { Ok(()) } else { Err(ExcitationError::Negative { quantity, found, unit }) }
}

/// Something must be there.
pub(super) const fn at_least_one(quantity: &'static str, found: usize) -> Result<(), ExcitationError> {
    if found > 0 { Ok(()) } else { Err(ExcitationError::TooFew { quantity, found, least: 1 }) }
}

/// A setting must be a finite number.
pub(super) const fn finite(quantity: &'static str, found: f64, unit: &'static str) -> Result<(), ExcitationError> {
    if found.is_finite() { Ok(()) } else { Err(ExcitationError::NotFinite { quantity, found, unit }) }
}

/// A list must have as many entries as the robot asks for.
pub(super) const fn same_length(quantity: &'static str, found: usize, expected: usize) -> Result<(), ExcitationError> {
    if found == expected { Ok(()) } else { Err(ExcitationError::Length { quantity, found, expected }) }
}

/// A motion must move as many joints as the robot has.
pub(super) const fn same_joints(found: usize, expected: usize) -> Result<(), ExcitationError> {
    if found == expected { Ok(()) } else { Err(ExcitationError::Joints { found, expected }) }
}
