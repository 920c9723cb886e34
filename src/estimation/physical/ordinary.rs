//! Ordinary least squares over physically consistent sets.
//!
//! ```text
//! min_φ ‖y − W K φ‖²        over consistent φ
//! ```
//! Its optimum is that of the semidefinite program (Sousa and Cortesão, 2014), found along a barrier's path. Where the ordinary
//! solution is consistent, it is that.

use super::fit::{STATED_IN_SI, ordinary};
use crate::estimation::consistent_set::Prior;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, LawException};

/// Ordinary least squares with every link a possible body.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConsistentOrdinary;

impl Estimator for ConsistentOrdinary {
    fn name(&self) -> &'static str {
        "pc-ols"
    }

    fn summary(&self) -> &'static str {
        "ordinary least squares over physically consistent sets"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        ordinary(self.name(), problem, Prior::None)
    }

    fn exceptions(&self) -> &[LawException] {
        STATED_IN_SI
    }
}
