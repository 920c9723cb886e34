//! Ordinary least squares over consistent sets near a prior, by the entropic distance.
//!
//! ```text
//! min_φ ‖y − W K φ‖²/(2σ̂²) + Σ_links ( tr(P₀⁻¹ P) − ln det P ) + Σ_drives ( x/x₀ − ln x )
//! ```
//! The distance is the Bregman divergence of −ln det, up to a constant: it does not depend on frames or on units of length and
//! mass, and is infinite where the set is not consistent. It counts in nats beside the equations' own likelihood; σ̂² is the
//! variance of their residual. Assumes what `pc-ols` does, and a nominal set near the arm. Fails by a prior that is wrong: it pulls
//! what the motion hardly shows, and the intervals do not know.
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

/// Ordinary least squares with the entropic distance from a prior.
#[derive(Clone, Copy, Debug, Default)]
pub struct EntropicPrior;

impl Estimator for EntropicPrior {
    fn name(&self) -> &'static str {
        "pc-ols-entropic"
    }

    fn summary(&self) -> &'static str {
        "consistent least squares near the nominal set, by the entropic distance"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        near_nominal(self.name(), problem, Prior::Entropic)
    }

    fn exceptions(&self) -> &[LawException] {
        PRIOR_IN_SI
    }
}
