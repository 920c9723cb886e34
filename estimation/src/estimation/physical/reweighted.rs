//! Huber's M-estimate over physically consistent sets.
//!
//! ```text
//! min_φ Σ_r ρ((y_r − w_r K φ)/s_i)        over consistent φ        ρ, s_i as for `irls-huber`
//! ```
//! Weights follow from the residual of the consistent solution, which follows from the weights, until the torque rests.
//! Intervals are those of the unconstrained solution of the last weights, cut to what is consistent.
//!
//! Assumes what `irls-huber` does, and links that are rigid bodies. Fails by leverage points as that, and where the model lacks so
//! much torque that the boundary holds the estimate: equations that are right then look wrong, and lose weight.
//!
//! Sources: P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2nd ed., Wiley, 2009, ch. 7; Q. Leboutet, J. Roux, A. Janot,
//! J. R. Guadarrama-Olvera, G. Cheng, "Inertial parameter identification in robotics: a survey", Applied Sciences 11(9), 2021, for the
//! estimators that combine the two.

use super::inference::restate;
use super::solution::consistent;
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::robust::{Loss, RobustFit, from_least_squares, robust_estimate, weighted_rows};
use crate::estimation::termination::Termination;

/// Iterations at most.
const ITERATIONS: usize = 100;

/// Change of the torque, in its robust standard deviations, at which the iteration has come to rest.
const AT_REST: f64 = 1e-6;

/// Huber's M-estimate with every link a possible body.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let (observation, equations) = (problem.observation, problem.factorised()?);
    let mut robust = from_least_squares(problem, equations.least_squares()?.solution(), Loss::Huber)?;
    let mut iterations = 0;
    loop {
        iterations += 1;
        // Weights are 1/s² times at most one: the noise is their unit.
        let plain = weighted_rows(observation, &robust.weights(observation))?;
        let fit = consistent(problem, &plain, 1.0, Prior::None)?;
        let before = robust.scaled_residual(observation);
        let next = RobustFit::at(observation, Loss::Huber, fit.beta.clone(), fit.termination);
        let moved = (next.scaled_residual(observation) - before).norm() / (observation.equations() as f64).sqrt();
        robust = next;
        let ended = moved <= AT_REST;
        let interrupted = problem.ended_after(iterations, ITERATIONS);
        if ended || interrupted.is_some() || iterations == ITERATIONS || !fit.termination.was_successful() {
            robust.termination = match fit.termination {
                Termination::Optimal { .. } if ended => Termination::Converged { iterations, last_step: moved },
                Termination::Optimal { .. } => {
                    interrupted.unwrap_or(Termination::IterationLimit { iterations, last_step: moved })
                }
                other => other,
            };
            let held = robust_estimate(name, problem, &robust)?;
            let own = RobustFit { beta: plain.solution().clone(), ..robust };
            return restate(problem, &robust_estimate(name, problem, &own)?, held, &fit);
        }
    }
}
