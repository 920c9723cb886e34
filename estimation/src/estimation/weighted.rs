//! Weighted least squares.
//!
//! ```text
//! β̂ = (WᵀΣ⁻¹W)⁻¹ WᵀΣ⁻¹ y        cov β̂ = (WᵀΣ⁻¹W)⁻¹ for noise that is white in time
//! ```
//! Σ is the n × n covariance of one sample's torque noise between the joints, the same for every sample: from the
//! scatter over periods, or, where nothing was repeated, from the residual of an ordinary fit. The scale of Σ does not
//! matter to β̂. Where the noise is correlated in time, the weights stay those of single samples and the covariance
//! is the sandwich with all lags, so that the error bars are right although the weights are not the best.
//!
//! Assumes exact states, and noise of mean zero whose covariance between joints is the same at every sample. Fails where Σ comes
//! from a residual that is no noise: a joint that the model explains badly then loses weight, and parameters that it shares with
//! others move. Noisy states and wrong equations bias it as they do `ols`.
//!
//! Sources: K. Radkhah, D. Kulic, E. Croft, "Dynamic parameter identification for the CRS A460 robot", IROS, 2007, eq. 6; J. Swevers,
//! C. Ganseman, D. B. Tükel, J. De Schutter, H. Van Brussel, "Optimal robot excitation and identification", IEEE Trans. Robotics and
//! Automation 13(5), 1997, for Σ from the scatter over periods.

use super::error::EstimationError;
use super::estimate::Estimate;
use super::linear_fit::LinearFit;
use super::problem::EstimationProblem;
use super::termination::Termination;

/// Least squares weighted with the inverse noise covariance of each sample.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    linear.estimate(name, problem, &linear.fit, Termination::Direct)
}
