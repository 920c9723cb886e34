//! Why a plan cannot be performed.

use super::phase::Phase;
use crate::input::SizeError;

/// Why a plan cannot be performed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A number is outside what is possible.
    #[error("{quantity} is {found}, expected {expected}")]
    Quantity {
        /// Which quantity, with its unit.
        quantity: &'static str,
        /// What was found.
        found: f64,
        /// What is possible.
        expected: &'static str,
    },
    /// It asks for more than is allowed.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A period does not hold a whole number of samples.
    #[error("a period of {period_s} s holds {samples} samples at {rate_hz} Hz, expected a whole number")]
    PeriodNotWhole {
        /// Length of the period, s.
        period_s: f64,
        /// Sampling rate, Hz.
        rate_hz: f64,
        /// Samples in a period.
        samples: f64,
    },
    /// The trajectory has another number of joints than the robot.
    #[error("the trajectory moves {found} joints, expected the robot's {expected}")]
    Dof {
        /// Joints of the trajectory.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// The commanded motion leaves a limit of the robot.
    #[error("joint \"{joint}\": {quantity} {found:.4} {unit} exceeds its limit {limit:.4} {unit} at t = {t:.3} s ({})", phase.name())]
    Limit {
        /// Name of the joint.
        joint: String,
        /// Position, speed or acceleration.
        quantity: &'static str,
        /// What is commanded.
        found: f64,
        /// What is allowed.
        limit: f64,
        /// Unit of both.
        unit: String,
        /// Time since the beginning of the experiment, s.
        t: f64,
        /// In which phase.
        phase: Phase,
    },
}
