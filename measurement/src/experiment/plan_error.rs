//! Why a plan cannot be performed.

use super::phase::Phase;
use crate::input::SizeError;

/// Why a plan cannot be performed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum PlanError {
    /// A number is outside what is possible.
    #[error("{quantity} is {found}, expected {expected}")]
    Quantity { quantity: &'static str, found: f64, expected: &'static str },
    /// It asks for more than is allowed.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A period does not hold a whole number of samples.
    #[error("a period of {period_s} s holds {samples} samples at {rate_hz} Hz, expected a whole number")]
    PeriodNotWhole { period_s: f64, rate_hz: f64, samples: f64 },
    /// The trajectory has another number of joints than the robot.
    #[error("the trajectory moves {found} joints, expected the robot's {expected}")]
    Dof { found: usize, expected: usize },
    /// The commanded motion leaves a limit of the robot.
    #[error("joint \"{joint}\": {quantity} {found:.4} {unit} exceeds its limit {limit:.4} {unit} at t = {t:.3} s ({})", phase.name())]
    Limit { joint: String, quantity: &'static str, found: f64, limit: f64, unit: String, t: f64, phase: Phase },
}
