//! Estimators that know that the measured motion has errors too.
//!
//! ```text
//! y_k = W(x_k) β + ε_k        x̂_k = x_k + ξ_k        x = (q, q̇, q̈)        cov ξ of joint j: G_j (3 × 3)
//! ```
//! Least squares takes W(x̂) for W(x). Products of errors with themselves, C = Σ ΔWᵀPΔW, then add to the
//! information A and draw the parameters towards zero, however long the recording.

mod equation_noise;
pub(super) mod maximum_likelihood;
mod noise;
pub(super) mod total;

pub(super) use equation_noise::motion_noise;
