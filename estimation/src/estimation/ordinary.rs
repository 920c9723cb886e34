//! Ordinary least squares.
//!
//! ```text
//! β̂ = (WᵀW)⁻¹ Wᵀ y        cov β̂ = (WᵀW)⁻¹ Wᵀ C W (WᵀW)⁻¹
//! ```
//! Every joint's residual counts the same in N·m, at any noise. Unbiased where the states are exact; its
//! covariance is that of the measured noise, not of an assumed equal one.
//!
//! Assumes exact states, and torque that differs from the model by noise of mean zero which does not depend on the motion; nothing
//! of its size. Fails where joints' noise differs much: the loud ones then decide parameters that quiet ones show too (`wls`).
//! Noisy states draw parameters towards zero (`tls`, `ml`, `iv`), and one wrong equation moves them without bound (`irls-tukey`,
//! `mm`).
//!
//! Sources: C. G. Atkeson, C. H. An, J. M. Hollerbach, "Estimation of inertial parameters of manipulator loads and links",
//! International Journal of Robotics Research 5(3), 1986; Å. Björck, *Numerical Methods for Least Squares Problems*, SIAM, 1996, for
//! the solution by orthogonal factors.

use super::error::EstimationError;
use super::estimate::Estimate;
use super::linear_fit::LinearFit;
use super::problem::EstimationProblem;
use super::termination::Termination;

/// Ordinary least squares on the base columns.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let linear = LinearFit::ordinary(&*problem.factorised()?)?;
    linear.estimate(name, problem, &linear.fit, Termination::Direct)
}
