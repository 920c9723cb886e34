//! Which variables make a smooth function smallest, where no row `aᵀ x ≤ b` and no smooth limit `g(x) ≤ 0` is broken?
//!
//! ```text
//! min f(x)   so that   A x ≤ b,   g(x) ≤ 0
//! ```
//! Sequential quadratic programming whose rows come from a [`RowSource`] as they are violated, so that a limit can be
//! held at the extrema of a curve, wherever they lie. Nothing here depends on trajectories or robots.

mod active_set;
mod brent;
mod error;
mod quadratic;
#[cfg(test)]
mod quadratic_tests;
mod restoration;
mod row;
mod sequential;
#[cfg(test)]
mod sequential_tests;
mod smooth;
mod vectors;

pub use brent::{CurvePoint, climb};
pub use error::QuadraticError;
pub use quadratic::{QuadraticSolution, solve_quadratic};
pub use restoration::nearest_inside;
pub use row::{LinearLimits, Row, RowSource};
pub use sequential::{Objective, Progress, Sequential, SequentialSettings};
pub use smooth::{CombinedLimits, SmoothLimits, SmoothRow};
pub use vectors::{dot, square};
