//! What every estimator is: a rule that turns measurements into parameters.

use std::fmt;

use super::error::EstimationError;
use super::estimate::Estimate;
use super::law::LawException;
use super::problem::EstimationProblem;

/// A rule that turns measurements into parameters.
///
/// It obeys every [`EstimatorLaw`](super::EstimatorLaw) but those that it names in [`Estimator::exceptions`];
/// `conformance::estimator_laws` shows it.
pub trait Estimator: fmt::Debug + Send + Sync {
    /// Its name on the command line and in files.
    fn name(&self) -> &str;

    /// What it minimises or solves, in one line.
    fn summary(&self) -> &str;

    /// Estimates the base parameters.
    ///
    /// # Errors
    /// [`EstimationError`] where the equations have no answer or something that it needs is missing.
    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError>;

    /// The laws that it does not obey, each with the reason.
    fn exceptions(&self) -> &[LawException] {
        &[]
    }
}
