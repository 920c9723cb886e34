//! Why a reduction cannot be made.

use super::method::Method;
use crate::model::ColumnsError;

/// Why a reduction cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum BaseError {
    /// The states are of another robot.
    #[error("states of {found} joints, expected {expected} for robot \"{robot}\"")]
    Dof { robot: String, found: usize, expected: usize },
    /// Fewer samples than `radkhah2007` step 1 asks for.
    #[error("{found} samples, expected at least {expected}")]
    TooFewSamples { found: usize, expected: usize },
    /// A number among the states, or a column of the regressor made from them, is not finite.
    #[error("sample {sample} gives a regressor entry {value}, expected finite numbers")]
    NotFinite { sample: usize, value: f64 },
    /// A column depends on more than the motion.
    #[error(transparent)]
    Columns(#[from] ColumnsError),
    /// The structural recursion cannot take the states of a trajectory.
    #[error("method \"{}\" on a given trajectory, expected \"paper\" or \"qr\"", method.name())]
    NoTrajectory { method: Method },
}
