//! What can keep an estimator from an answer.

use crate::linalg::LeastSquaresError;

/// Why there is no estimate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimationError {
    /// Fewer equations than parameters.
    #[error("{equations} equations for {parameters} base parameters, expected at least as many; use more samples")]
    TooFewEquations {
        /// Equations.
        equations: usize,
        /// Base parameters.
        parameters: usize,
    },
    /// The trajectory does not tell a base parameter from those before it.
    #[error(
        "base parameter {parameter} is not excited: {independent:.1e} of its column is independent of those before \
         it, expected more than {least:.1e}; use another trajectory, or reduce for this one"
    )]
    NotExcited {
        /// Its name.
        parameter: String,
        /// The fraction of its column that is independent.
        independent: f64,
        /// The least fraction that counts.
        least: f64,
    },
    /// Two inputs do not belong together.
    #[error("{quantity}: {found}, expected {expected}")]
    Mismatch {
        /// What does not fit.
        quantity: &'static str,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The estimator needs something that the problem does not hold.
    #[error("estimator \"{estimator}\" needs {missing}, and the problem holds none")]
    Missing {
        /// Name of the estimator.
        estimator: &'static str,
        /// What it needs.
        missing: &'static str,
    },
    /// The equations themselves are at fault.
    #[error("least squares: {0}")]
    LeastSquares(#[from] LeastSquaresError),
}
