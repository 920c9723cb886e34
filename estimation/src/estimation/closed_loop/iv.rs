//! Instrumental variables from a simulated motion.
//!
//! ```text
//! β = (ZᵀΣ⁻¹W)⁻¹ ZᵀΣ⁻¹ y        Z = W(q_s, q̇_s, q̈_s) along the motion simulated at the last β, repeated until β is at rest
//! ```
//! Errors of the measured motion are in W and bias least squares by `E WᵀΣ⁻¹W`, which holds their squares; the simulated motion
//! has none of them, so `E ZᵀΣ⁻¹W` does not. The estimate is consistent whatever Z is, as long as Z goes with the true regressor
//! and not with the noise; an incomplete model or a servo that is not quite as stated widens the intervals more than it biases.
//! Intervals are the sandwich with B = Σ⁻¹Z.
//!
//! Assumes that the model explains torque but for noise, and that servo, reference and start are known. Fails where the simulated
//! motion hardly goes with the measured one. Whether it was needed is said by the Durbin–Wu–Hausman test
//! ([`super::endogeneity`]) in a finding: where it was not, `wls` has the shorter intervals.
//!
//! Source: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial robot identification",
//! IEEE Trans. Control Systems Technology 22(1), 2014.

use super::instrumental_fit::InstrumentalFit;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;

/// Instrumental variables with the regressor along the simulated motion as instruments.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let found = InstrumentalFit::find(name, problem, None)?;
    found.estimate(name, problem, &found.fit, found.termination)
}
