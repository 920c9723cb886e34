//! Direct and inverse dynamic identification over physically consistent sets.
//!
//! ```text
//! min_φ ‖y − τ_s(K φ)‖_Σ        over consistent φ        ∂τ_s/∂β ≈ Z as for `didim`
//! ```
//! Each step goes to the consistent set that explains the linear equations around the last one best, so that the arm can be
//! simulated after every step that is not too long. Assumes what `didim` does, and links that are rigid bodies. Fails where `didim`
//! does, and where a model that lacks torque is held at the boundary. Intervals are those of the unconstrained solution of the last
//! equations, cut to what is consistent. Where the search does not come to rest, the result is the consistent set by the last
//! equations, and the [`Termination`](crate::estimation::Termination) says so.
//!
//! Source: Q. Leboutet, J. Roux, A. Janot, J. R. Guadarrama-Olvera, G. Cheng, "Inertial parameter identification in robotics: a
//! survey", Applied Sciences 11(9), 2021, for the estimators that combine the two.

use super::fit;
use super::solution::consistent;
use crate::estimation::closed_loop::{TorqueSearch, TorqueSlope, torque_search};
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::LeastSquares;

/// Simulated against measured torque, with every link a possible body.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let onto = |fit: &LeastSquares| Ok(consistent(problem, fit, 1.0, Prior::None)?.beta);
    let TorqueSearch { around, weights, rest, .. } = torque_search(name, problem, TorqueSlope::Regressor, Some(&onto))?;
    let equations = Factorisation::new(&around)?;
    let linear = LinearFit::with_weights(&equations, weights)?;
    let problem = EstimationProblem { observation: &around, factorisation: Some(&equations), ..*problem };
    fit::estimate(name, &problem, &linear, Prior::None, Some(rest.termination))
}
