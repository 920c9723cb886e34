//! Weighted least squares over physically consistent sets.
//!
//! ```text
//! min_φ (y − W K φ)ᵀ Σ⁻¹ (y − W K φ)        over consistent φ        Σ as for `wls`
//! ```
//! As `pc-ols`, with each joint's noise.

use super::fit::{STATED_IN_SI, estimate};
use crate::estimation::consistent_set::Prior;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, LawException};

/// Weighted least squares with every link a possible body.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConsistentWeighted;

impl Estimator for ConsistentWeighted {
    fn name(&self) -> &'static str {
        "pc-wls"
    }

    fn summary(&self) -> &'static str {
        "weighted least squares over physically consistent sets"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let equations = problem.factorised()?;
        let problem = problem.with_factorisation(&equations);
        let linear = LinearFit::weighted(&equations)?;
        estimate(self.name(), &problem, &linear, Prior::None)
    }

    fn exceptions(&self) -> &[LawException] {
        STATED_IN_SI
    }
}
