//! Why a study cannot begin.

use super::plan_error::StudyPlanError;
use super::random_truth::TruthError;
use crate::base::BaseError;
use crate::excitation::ExcitationError;

/// Why a study cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The plan asks for something that is not there.
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
}
