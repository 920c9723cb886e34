//! Estimators that a few wrong equations do not move: M-estimators by iterated weights, and MM-estimators.
//!
//! ```text
//! Σ_r ψ(u_r) w_r / s_i = 0        u_r = (y_r − w_r β) / s_i, equation r of joint i        ψ(u) = ω(u) u
//! ```
//! s_i is the scale of joint i's residuals by the median of their absolute values (MAD), so joints weigh by their noise, as in weighted
//! least squares; that noise of joints is related is not used. Intervals: see [`inference`].
//!
//! References: P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2nd ed., Wiley, 2009, ch. 7; R. A. Maronna et al., *Robust
//! Statistics: Theory and Methods*, 2nd ed., Wiley, 2019, ch. 4 and 5.

mod components;
mod inference;
mod iteration;
mod loss;
pub(super) mod mm;
pub(super) mod reweighted;
mod s_estimate;
mod scale;

pub(super) use inference::estimate as robust_estimate;
pub(super) use iteration::{RobustFit, from_least_squares, weighted_rows};
pub(super) use loss::Loss;
