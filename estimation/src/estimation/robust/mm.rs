//! The MM-estimate: the high breakdown point of an S-estimate, and nearly the efficiency of least squares.
//!
//! ```text
//! 1. β_S with the smallest M-scale of all residuals        breakdown point one half, in torque and in the rows
//! 2. s_i = M-scale of joint i's residuals at β_S, kept
//! 3. Σ_r ψ((y_r − w_r β̂)/s_i) w_r/s_i = 0 from β_S          ψ Tukey's with 4.685: 95 % efficient where noise is normal
//! ```
//! For recordings with wrong states as well as wrong torques: slips of a clock, an encoder that jumps, a collision. Assumes that
//! fewer than half of the equations are wrong. Fails where the wrong equations agree with each other better than the right ones do,
//! or where without them the motion does not show a parameter. Costs some hundred least-squares fits.
//!
//! Source: V. J. Yohai, "High breakdown-point and high efficiency robust estimates for regression", Annals of Statistics 15(2),
//! 1987.

use super::inference;
use super::iteration::{Scales, iterate};
use super::loss::Loss;
use super::s_estimate;
use super::scale::m_scales;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;

/// Tukey's M-estimate from the fit with the smallest M-scale.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let (observation, equations) = (problem.observation, problem.factorised()?);
    let start = s_estimate::search(problem, equations.least_squares()?.solution())?;
    let scales = m_scales(observation, &observation.residual(&start.beta));
    let mut robust = iterate(problem, start.beta, Loss::Tukey, Scales::Fixed(scales))?;
    robust.termination = both(start.termination, robust.termination);
    inference::estimate(name, problem, &robust)
}

/// The end of two iterations, one after the other.
fn both(first: Termination, second: Termination) -> Termination {
    match (first, second) {
        (Termination::Converged { iterations: before, .. }, Termination::Converged { iterations, last_step }) => {
            Termination::Converged { iterations: before + iterations, last_step }
        }
        (first, second) if first.was_successful() => second,
        (first, _) => first,
    }
}
