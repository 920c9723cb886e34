//! Instrumental variables over physically consistent sets.
//!
//! ```text
//! min_φ ‖ZᵀΣ⁻¹ (y − W K φ)‖²        over consistent φ, in the metric of (ZᵀΣ⁻¹Z)⁻¹        Z as for `iv`, at K φ
//! ```
//! The set nearest to the solution by instruments, by the covariance of that solution; the arm is simulated at the set, which
//! always has a mass matrix, until both agree. Without the errors of the measured motion in it, as `iv`. Assumes what `iv` does,
//! and links that are rigid bodies. Fails where `iv` does, and where a model that lacks torque is held at the boundary. Intervals
//! are those of the unconstrained solution of the last instruments, cut to what is consistent.
//!
//! Source: Q. Leboutet, J. Roux, A. Janot, J. R. Guadarrama-Olvera, G. Cheng, "Inertial parameter identification in robotics: a
//! survey", Applied Sciences 11(9), 2021, for the estimators that combine the two.

use super::inference::restate;
use super::solution::consistent;
use crate::estimation::closed_loop::InstrumentalFit;
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::LeastSquares;

/// Instrumental variables with every link a possible body.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    // Weights are 1/σ²: the noise is their unit.
    let nearest = |fit: &LeastSquares| consistent(problem, fit, 1.0, Prior::None);
    let found = InstrumentalFit::find(name, problem, Some(&|fit| Ok(nearest(fit)?.beta)))?;
    let fit = nearest(&found.in_own_covariance()?)?;
    let termination = found.termination.with_last_step(fit.termination);
    let plain = found.estimate(name, problem, &found.fit, Termination::Direct)?;
    let held = found.fit.with_solution(fit.beta.clone(), found.fit.inverse_information())?;
    let held = found.estimate(name, problem, &held, termination)?;
    restate(problem, &plain, held, &fit)
}
