//! What a residual says: does it follow time, speed, load or position, and is it white? Each answer is a sentence with its numbers.
//!
//! ```text
//! x̃ = (1 − W (WᵀPW)⁻¹ WᵀP) x        r̃ likewise        θ = x̃ᵀP r̃ / x̃ᵀP x̃        std θ by the covariance of r̃ over all lags
//! ```
//! x is a shape over one joint's equations: what a term of its own would add to the model. What the model's parameters can take up is
//! taken out of it first, so that a shape that the model has is not tested, and θ is the coefficient of one that it lacks. P weights
//! joints with their residual.
//!
//! p-values are adjusted (Holm) over all joints and shapes of one figure. A shape is named where it takes at least 5 % of the power of the
//! joint's residual, has one sign in four of five parts of the record, and is not nearly all in the model. In a motion of one harmonic a spring is an inertia (q ∝ q̈),
//! and is not tested. A shape that is found need not be the cause: shapes resemble each other, and only the one that takes most is
//! named for each joint.

mod shape;
#[cfg(test)]
mod tests;
mod trends;
mod whiteness;

pub use shape::{Against, ResidualShape};
pub use trends::{JointTrace, ResidualTests, ResidualTrends, Trend};
pub use whiteness::Whiteness;
pub(super) use whiteness::probability;
