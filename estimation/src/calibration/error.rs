//! Why a calibration has no result.

use crate::linalg::LeastSquaresError;

/// Why there is no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum CalibrationError {
    /// The interface gives no motor voltage.
    #[error(
        "the recording holds no motor voltages, expected one for each joint and sample; where the interface gives \
         none, a known payload shows the torque constant instead"
    )]
    NoVoltage,
    /// The recording does not have what the calibration needs.
    #[error("{quantity}: {found}, expected {expected}")]
    Unfit { quantity: &'static str, found: String, expected: &'static str },
    /// The equations are rank-deficient or cannot be solved: the motion does not determine a parameter.
    #[error("the motion does not separate {parameter} from the others: {fault}")]
    NotExcited { parameter: &'static str, fault: LeastSquaresError },
}

impl CalibrationError {
    /// Where a recording does not have what a calibration needs.
    pub(super) fn unfit(quantity: &'static str, found: impl ToString, expected: &'static str) -> Self {
        Self::Unfit { quantity, found: found.to_string(), expected }
    }
}
