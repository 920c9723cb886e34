//! Why there is no estimate.

use std::error::Error;
use std::sync::Arc;

use super::closed_loop::ClosedLoopError;
use crate::base::BaseError;
use crate::linalg::LeastSquaresError;
use crate::model::ColumnsError;
use crate::number::significant;
use crate::signal::SignalError;

/// Why there is no estimate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum EstimationError {
    /// Fewer equations than parameters.
    #[error("{equations} equations for {parameters} base parameters, expected at least as many; use more samples")]
    TooFewEquations { equations: usize, parameters: usize },
    /// The equations show no base parameter: every joint stands still.
    #[error(
        "no base parameter acts in the {equations} equations, expected at least one; use samples in which joints move"
    )]
    NothingActs { equations: usize },
    /// The trajectory does not separate a base parameter from those before it.
    #[error(
        "base parameter {parameter} is not excited: {independent:.1e} of its column is independent of those before \
         it, expected more than {least:.1e}; use another trajectory, or reduce for this one"
    )]
    NotExcited { parameter: String, independent: f64, least: f64 },
    /// A base parameter acts in rows that are no equation.
    #[error(
        "base parameter {parameter} is not shown by the equations: its column is {share:.0e} there of what it is in the rows that are \
         left out; use rows nearer to reversals of its joint, or leave its term out"
    )]
    OutsideOfEquations { parameter: String, share: f64 },
    /// Two inputs that belong together differ in size.
    #[error("{quantity}: {found}, expected {expected}")]
    Count { quantity: &'static str, found: usize, expected: usize },
    /// The reduction is not one of the regressor's parameters.
    #[error("the {found} parameters of the reduction are not the regressor's {expected}")]
    OtherParameters { found: usize, expected: usize },
    /// The regressor lacks a parameter of the estimate.
    #[error("parameter of the estimate: {parameter}, expected one of the regressor's")]
    UnknownParameter { parameter: String },
    /// A term among the columns cannot be estimated from motion and torque.
    #[error("{0}")]
    Columns(#[from] ColumnsError),
    /// Friction of the load did not come to rest.
    #[error(
        "friction of the load: the fit still changes by {} after {rounds} rounds, expected at most {rest}; leave \"load\" out of the \
         columns",
        significant(*change, 2)
    )]
    LoadNotAtRest { change: f64, rounds: usize, rest: f64 },
    /// The estimate is of another base.
    #[error("base parameters: {}, expected {}", found.join(" "), expected.join(" "))]
    OtherBase { found: Vec<String>, expected: Vec<String> },
    /// Two estimates are of two robots.
    #[error("robot of the second estimate: {second}, expected {first}")]
    OtherRobot { first: String, second: String },
    /// Two estimates share no base parameter.
    #[error("parameters: none in both estimates, expected the same base parameters")]
    NothingShared,
    /// An estimator from outside gave something that is no number.
    #[error("{quantity}: found one that is not finite, expected finite numbers")]
    NotFinite { quantity: &'static str },
    /// The covariance of an estimate is not positive definite.
    #[error("covariance: one that is not positive definite, expected a positive definite one")]
    NotDefinite,
    /// The estimator needs something that the problem does not hold.
    #[error("estimator \"{estimator}\" needs {part}, and the problem holds none")]
    Missing { estimator: String, part: &'static str },
    /// An estimator that simulates the arm in closed loop cannot.
    #[error("estimator \"{estimator}\" simulates the arm in closed loop: {reason}")]
    ClosedLoop { estimator: String, reason: ClosedLoopError },
    /// The simulated motion does not excite a parameter that the measured one does.
    #[error(
        "base parameter {parameter} has no instrument: the simulated motion does not excite it, the measured one does"
    )]
    NoInstrument { parameter: String },
    /// Instruments that do not go with the regressor.
    #[error("instruments: ZᵀW is singular, expected a simulated motion that goes with the measured one")]
    WeakInstruments,
    /// The robot has no base parameters.
    #[error("base parameters: {0}")]
    Base(#[from] BaseError),
    /// A filter cannot be made.
    #[error("{0}")]
    Signal(#[from] SignalError),
    /// An estimator from outside failed, in its own words.
    #[error("{0}")]
    External(ExternalError),
    /// An observer ended the work before there was anything to return.
    #[error("interrupted")]
    Interrupted,
    /// The equations themselves are at fault.
    #[error("least squares: {0}")]
    LeastSquares(#[from] LeastSquaresError),
}

/// The error of an estimator from outside, as it returned it. Two are equal if they are the same one.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct ExternalError(pub Arc<dyn Error + Send + Sync>);

impl PartialEq for ExternalError {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl EstimationError {
    /// [`Self::Count`] unless two numbers are equal.
    pub(super) fn unless_equal(quantity: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Count { quantity, found, expected }) }
    }

    /// The error of an estimator from outside.
    ///
    /// ```
    /// # use armid_estimation as armid;
    /// use armid::estimation::EstimationError;
    /// assert_eq!(EstimationError::external("no answer").to_string(), "no answer");
    /// ```
    pub fn external(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::External(ExternalError(error.into().into()))
    }
}
