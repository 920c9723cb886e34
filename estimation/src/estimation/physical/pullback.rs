//! Ordinary least squares over consistent sets near a prior, by the constant pullback metric.
//!
//! ```text
//! min_φ ‖y − W K φ‖²/(2σ̂²) + ½ Σ_links tr((P₀⁻¹ΔP)²) + ½ Σ_drives (Δx/x₀)²        over consistent φ
//! ```
//! The metric of positive definite matrices, taken at the prior alone: the entropic distance to second order, quadratic. Does not
//! depend on frames or units of length and mass. Assumes what `pc-ols` does, and a nominal set near the arm. Fails by a prior that
//! is wrong: it pulls what the motion hardly shows.
//!
//! Source: T. Lee, P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach",
//! IEEE Trans. Robotics 36(2), 2020, section IV.

use super::fit::{PRIOR_IN_SI, near_nominal};
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::estimator::Estimator;
use crate::estimation::law::LawException;
use crate::estimation::problem::EstimationProblem;

/// Ordinary least squares with the constant pullback distance from a prior.
#[derive(Clone, Copy, Debug, Default)]
pub struct PullbackPrior;

impl Estimator for PullbackPrior {
    fn name(&self) -> &'static str {
        "pc-ols-pullback"
    }

    fn summary(&self) -> &'static str {
        "consistent least squares near the nominal set, by the constant pullback distance"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        near_nominal(self.name(), problem, Prior::Pullback)
    }

    fn exceptions(&self) -> &[LawException] {
        PRIOR_IN_SI
    }
}
