//! Filters: parameters that walk at random, corrected sample after sample.
//!
//! ```text
//! β_{k+1} = β_k + w_k, cov w = Q        y_k = W_k β_k + ε_k, cov ε = Σ        states from the recording
//! ```
//! The measurement is linear in β, so that all Kalman filters of this kind have the same posterior: `ekf` stands for those by square
//! roots, sigma points and central differences, too. With Q → 0 it is that of weighted least squares, and `pf` has it but for what random
//! points miss. The joint filter of states and parameters (positions measured, forward dynamics), which
//! BIRDy has, is missing.
//!
//! [`walk`] states prior and Q. For parameters that drift, a warm gear say, a filter follows; for constant
//! ones it is weighted least squares with more to choose.

mod belief;
pub(super) mod ekf;
pub(super) mod pf;
mod walk;
