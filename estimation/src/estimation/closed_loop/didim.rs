//! Direct and inverse dynamic identification.
//!
//! ```text
//! min ‖y − τ_s(β)‖_Σ        ∂τ_s/∂β ≈ Z(β) = W(q_s, q̇_s, q̈_s)        β ← β + (ZᵀΣ⁻¹Z)⁻¹ ZᵀΣ⁻¹ (y − τ_s(β))
//! ```
//! The direct model simulates the arm under its known servo along the recorded reference, the inverse model is linear along that
//! motion, and measured torque is all that is compared: no noise of positions is in the regressor, and no velocity or
//! acceleration is derived from them. The servo follows the same reference with nearly the same motion whatever the
//! parameters, which is why Z stands for the derivative.
//!
//! Assumes the servo (structure, gains, rate), its reference and its start known, and the model complete: what the arm has and
//! the model lacks moves the simulated motion too. Fails where the servo is not as stated, or so soft that its motion depends
//! on β by more than a small part: then the steps do not come to rest, or rest beside the minimum (`clie` has the exact slope).
//! Intervals are those of the torque's noise, around Z.
//!
//! Source: M. Gautier, A. Janot, P.-O. Vandanjon, "A new closed-loop output error method for parameter identification of robot
//! dynamics", IEEE Trans. Control Systems Technology 21(2), 2013.

use super::torque_error::{self, TorqueSlope};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;

/// Simulated against measured torque, with the regressor along the simulated motion for its slope.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    torque_error::estimate(name, problem, TorqueSlope::Regressor)
}
