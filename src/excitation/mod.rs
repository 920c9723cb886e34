//! How should the arm move so that its parameters show best, without breaking a limit?
//!
//! The paper's sections II.C, II.D and III: finite Fourier series as trajectories, a criterion on the information
//! `M = W_bᵀ Σ⁻¹ W_b` of the base columns, limits as constraints, and an optimiser of our own.

mod error;
mod fourier;
pub mod optimiser;
pub mod table_one;
mod trajectory;
mod trajectory_file;
mod trigonometric;

pub use error::ExcitationError;
pub use fourier::{FourierJoint, FourierTrajectory};
pub use trajectory::Trajectory;
pub use trigonometric::{EXTREMUM_TOLERANCE, Extremum, TrigonometricPolynomial};
