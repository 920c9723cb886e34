//! The bodies and drives that a model file has a place for, which explain a log best.
//!
//! ```text
//! min_φ  ½ Σ_j ‖y_j − W_j φ‖²/σ_j²  +  w D(φ)
//! D(φ) = Σ_links [ tr S_i/(1 − ε) − ln det S_i − ln(r_i − a_i) − ln(b_i − r_i) + c_i r_i ] + Σ_terms g_k (z_k − ln z_k)
//! S_i = L_i⁻¹ P_i L_i⁻ᵀ − ε 1        P⁰_i = L_i L_iᵀ        r_i = m_i/m⁰_i        z_k = x_k/x⁰_k
//! ```
//! W has the columns of the file's own terms alone: what a format cannot hold is zero in the fit, and what it can hold takes its share.
//! σ_j is the residual of joint j. D is the log-det divergence of pseudo-inertias from those of a guess, least at the guess, infinite
//! where a body is none: every eigenvalue of P_i relative to P⁰_i exceeds ε = 1e-3, and its mass stays between a_i and b_i of the guess.
//! A coefficient of either sign has `½ g_k z_k²` in place of the last term.
//!
//! The weight w is the largest that costs no significant error on blocks of the log which the fit has not seen ([`PriorWeight`]).
//!
//! Not done: bounds by the shapes of links, as the estimators `pc-…` have them.
//!
//! Reference: T. Lee, P. M. Wensing, F. C. Park, "Geometric robot dynamic identification: a convex programming approach", IEEE Trans.
//! Robotics 36(2), 2020.

mod bodies;
mod drives;
mod equations;
mod fit;
mod guess;
mod minimum;
mod one_body;
mod weight;
#[cfg(test)]
mod tests;

pub use fit::{ModelFit, fit_model};
pub use guess::{BodyOrigin, ModelGuess};
pub(super) use one_body::fit_body;
pub use weight::PriorWeight;
