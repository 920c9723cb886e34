//! What can stop a design before it starts.

use crate::base::BaseError;
use crate::model::RobotFault;

/// Why a trajectory or a design problem cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// A trajectory file is not TOML, or a key or a value is not what the format has.
    #[error("line {line}, column {column}: {message}")]
    File {
        /// Line of the fault, from one.
        line: usize,
        /// Column of the fault, from one, in characters.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// A trajectory file has a table `[certificate]` that is none.
    #[error("certificate: {message}")]
    Certificate {
        /// What was found and what was expected.
        message: String,
    },
    /// A trajectory cannot be as specified.
    #[error("trajectory: {quantity} is {found}, expected {expected}")]
    Trajectory {
        /// Which quantity.
        quantity: String,
        /// What was found.
        found: String,
        /// What is possible.
        expected: String,
    },
    /// A setting of the design problem is outside what is possible.
    #[error("design: {quantity} is {found}, expected {expected}")]
    Problem {
        /// Which quantity.
        quantity: String,
        /// What was found.
        found: String,
        /// What is possible.
        expected: String,
    },
    /// The base parameters could not be found.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// The robot's limits or drives are impossible.
    #[error(transparent)]
    Robot(#[from] RobotFault),
}
