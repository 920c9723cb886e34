//! Why a study cannot begin, or be summed up.

use super::plan_error::StudyPlanError;
use super::random_truth::TruthError;
use super::validation::ValidationError;
use crate::base::BaseError;
use crate::excitation::ExcitationError;

/// Why a study cannot begin, or be summed up.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The plan asks for something that does not exist.
    #[error(transparent)]
    Plan(#[from] StudyPlanError),
    /// The robot cannot be reduced.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// A truth cannot be drawn.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// A trajectory cannot be made.
    #[error(transparent)]
    Excitation(#[from] ExcitationError),
    /// The motions on which predictions are tested cannot be drawn.
    #[error(transparent)]
    Validation(#[from] ValidationError),
    /// The numbers of its runs cannot be read where they are held.
    #[error("the numbers of the runs cannot be read: {0}")]
    Runs(String),
}
