//! What the last link carries: the difference between two estimates of one arm, with and without a load.
//!
//! ```text
//! β_with − β_without = K_n θ + δ + e        e ~ N(0, C)        δ = 0 but for friction and offsets
//! ```
//! θ are the load's ten parameters in the frame of link n, and K_n the last link's columns of the reduction: a load that is fixed to that
//! link adds to its parameters and to nothing else. Friction and offsets are the arm's own, and both logs share them but for a change δ
//! that is as large as both logs show it to be ([`change`]). On a narrow motion the weight of a load is nearly an offset: an offset that
//! is free in each log takes the mass for itself. With the information of both estimates this is the generalised least-squares fit of all
//! equations of both logs together.
//!
//! What of θ the motion can show follows from K_n; of the rest nothing is said. Where the base parameters scatter more than
//! their covariances say, intervals are widened by that factor. No mass is below zero: where the free estimate is, that is said with its
//! cause ([`NegativeMass`]). The body is the possible one that agrees best ([`body`]).
//!
//! C adds what both estimates say of themselves, and what the robot file declares: errors of offsets and friction are each log's own, an error
//! of a torque constant or a lag is one for both.
//!
//! Reference: D. A. Harville, "Maximum likelihood approaches to variance component estimation and to related problems", Journal of the
//! American Statistical Association 72(358), 1977, for δ.

mod body;
mod change;
#[cfg(test)]
pub(super) mod fixtures;
mod load;
#[cfg(test)]
mod tests;

pub use body::PayloadBody;
pub use load::{NegativeMass, NegativeMassCause, Payload, PayloadParameter, payload};
