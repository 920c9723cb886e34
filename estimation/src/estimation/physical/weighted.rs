//! Weighted least squares over physically consistent sets.
//!
//! ```text
//! min_φ (y − W K φ)ᵀ Σ⁻¹ (y − W K φ)        over consistent φ        Σ as for `wls`
//! ```
//! As `pc-ols`, with each joint's noise.
//!
//! Assumes what `wls` does, and links that are rigid bodies. Fails as `pc-ols` where the model lacks torque; a Σ from a residual
//! that is no noise also decides which joint gives way at the boundary.
//!
//! Sources: C. D. Sousa, R. Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear matrix inequality
//! approach", International Journal of Robotics Research 33(6), 2014; P. M. Wensing, S. Kim, J.-J. Slotine, "Linear matrix inequalities for
//! physically consistent inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018, for pseudo-inertias.

use super::fit;
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;

/// Weighted least squares with every link a possible body.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    fit::estimate(name, problem, &LinearFit::weighted(&*problem.factorised()?)?, Prior::None, None)
}
