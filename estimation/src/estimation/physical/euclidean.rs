//! Ordinary least squares over consistent sets near a prior, by the Euclidean distance in SI.
//!
//! ```text
//! min_φ ‖y − W K φ‖²/(2σ̂²) + |φ − φ₀|²/(2s²)        over consistent φ        s² the mean square of φ₀
//! ```
//! For comparison: a kilogram weighs as much as a kilogram metre squared, so a prior's masses hold and its inertias do not. Assumes
//! what `pc-ols` does, and a nominal set near the arm. Fails by a prior that is wrong: it pulls what the motion hardly shows.
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

/// Ordinary least squares with the Euclidean distance from a prior.
#[derive(Clone, Copy, Debug, Default)]
pub struct EuclideanPrior;

impl Estimator for EuclideanPrior {
    fn name(&self) -> &'static str {
        "pc-ols-euclidean"
    }

    fn summary(&self) -> &'static str {
        "consistent least squares near the nominal set, by the Euclidean distance in SI"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        near_nominal(self.name(), problem, Prior::Euclidean)
    }

    fn exceptions(&self) -> &[LawException] {
        PRIOR_IN_SI
    }
}
