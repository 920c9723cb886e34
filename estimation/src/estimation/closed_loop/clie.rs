//! The closed-loop input error.
//!
//! ```text
//! min ‖y − τ_s(β)‖_Σ        J = ∂τ_s/∂β of the simulation, exact        β ← β + (JᵀΣ⁻¹J)⁻¹ JᵀΣ⁻¹ (y − τ_s(β))
//! ```
//! What `didim` minimises, by Gauss–Newton with the derivative of servo and arm together: it comes to rest at the minimum however
//! soft the servo is, at the cost of simulating b sensitivities beside the motion. Steps that cannot be simulated, or raise the
//! sum of squares, are damped; the last iterate is returned with the reason.
//!
//! Assumes servo, reference and start known and the model complete, as `didim`. Fails where the servo does not hold the arm for
//! any start that is at hand, and where the sum of squares has several minima: it finds the one beside its start.
//!
//! Sources: E. Walter, L. Pronzato, *Identification of Parametric Models from Experimental Data*, Springer, 1997, for output
//! errors with sensitivities; Q. Leboutet et al., "Inertial parameter identification in robotics: a survey", Applied Sciences
//! 11(9), 2021, for the input error of a robot's closed loop.

use super::torque_error::{self, TorqueSlope};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;

/// Simulated against measured torque, with the exact slope of the simulation.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    torque_error::estimate(name, problem, TorqueSlope::Exact)
}
