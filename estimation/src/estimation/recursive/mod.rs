//! Filters: parameters that walk at random, corrected sample after sample.
//!
//! ```text
//! β_{k+1} = β_k + w_k, cov w = Q        y_k = W_k β_k + ε_k, cov ε = Σ        states from the recording
//! ```
//! The measurement is linear in β, so that all Kalman filters of this kind have the same posterior (`ekf`, `srekf`,
//! `ukf`, `srukf`, `cdkf`, `srcdkf` agree but for rounding, which tests show), and with Q → 0 it is that of weighted least squares. They
//! are here to be compared, each by its own algorithm; `pf` has the same posterior but for what random points miss. Filters that estimate states as well need a simulated model, and are
//! others.
//!
//! [`walk`] states prior and Q. For parameters that drift, a warm gear say, a filter follows; for constant
//! ones it is weighted least squares with more to choose.

mod belief;
mod cdkf;
mod ekf;
mod pf;
mod sigma;
mod srcdkf;
mod srekf;
mod srukf;
mod square_root;
mod ukf;
mod walk;

pub use cdkf::CentralDifferenceKalmanFilter;
pub use ekf::ExtendedKalmanFilter;
pub use pf::ParticleFilter;
pub use srcdkf::SquareRootCentralDifferenceKalmanFilter;
pub use srekf::SquareRootExtendedKalmanFilter;
pub use srukf::SquareRootUnscentedKalmanFilter;
pub use ukf::UnscentedKalmanFilter;
