//! What the model lacks, as far as the recording shows it, in the covariance of an estimate.
//!
//! ```text
//! y_i = W_i β + δ_i + ε_i        δ_i ~ N(0, K_i)        K_i = Σ_k v_ik Φ_ik Φ_ikᵀ + w_i R_i(0)
//! cov β̂ = A⁻¹ Bᵀ (C + K) B A⁻ᵀ
//! ```
//! A fit's residual is orthogonal to the regressor: what biases β̂ is not in it, and no covariance of the residual alone
//! holds it. So the torque δ_i that repeats in every period and that no parameter explains is taken for a random function of
//! speed, load, position, acceleration and time ([`features`]). Its sizes v_ik are those that the visible part has, by
//! the restricted likelihood ([`sizes`]); the functions then stand for the part that the regressor hides too.
//!
//! That the residual of a joint's own fit is no more than the scatter over periods leaves is tested by F (a lack of fit against
//! pure error), and for each group of functions on its own. Where no joint fails a test there is no discrepancy. Where one does, those
//! that fail have functions of their own; the laws that all joints share, and what repeats and looks like noise, are those of
//! every joint that has more equations than parameters. The tests and the functions need the states of the equations: where an estimator has
//! none, there is no discrepancy.
//!
//! References: M. C. Kennedy, A. O'Hagan, "Bayesian calibration of computer models", J. R. Statist. Soc. B 63(3), 2001, for the
//! discrepancy; J. Swevers et al., "Optimal robot excitation and identification", IEEE Trans. Robotics and Automation
//! 13(5), 1997, and R. Pintelon, J. Schoukens, *System Identification*, 2012, for scatter over periods as pure error.

mod arm;
mod blocks;
mod features;
mod joint;
mod misfit;
mod sizes;

pub(super) use arm::Discrepancy;
