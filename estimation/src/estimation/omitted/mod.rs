//! Torque by laws that the model omits, and what it may have done to an estimate.
//!
//! ```text
//! y = W β + D θ + ε        β̂ − β = A⁻¹ Bᵀ (D θ + ε)        cov β̂ += G E[θ θᵀ | y] Gᵀ,  G = A⁻¹ Bᵀ D
//! ```
//! A column of D is the torque of one law at one drive, by the parameters that were estimated ([`laws`]): friction of the load, a current that
//! lags, a spring, friction that follows displacement. What the regressor does not hide of D shows θ ([`evidence`]); how large a law is in an arm is
//! integrated out ([`scales`]). So the uncertainty that a law adds never becomes zero, and nothing is tuned: scales are the realistic levels in the list of
//! effects.
//!
//! No periods are needed: without them the noise is that of the residual that is left with the laws.
//!
//! Reference: M. C. Kennedy, A. O'Hagan, "Bayesian calibration of computer models", J. R. Statist. Soc. B 63(3), 2001, for a discrepancy with a
//! prior; its directions here are those of laws.

mod evidence;
mod laws;
mod scales;
mod search;
mod torque;

pub(super) use search::omitted_torque;
pub(super) use torque::OmittedTorque;
