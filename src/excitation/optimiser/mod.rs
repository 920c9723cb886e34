//! The optimiser: sequential quadratic programming whose rows are limits at the true extrema of the trajectory.

mod active_set;
mod quadratic;
#[cfg(test)]
mod quadratic_tests;
mod row;
mod sequential;
#[cfg(test)]
mod sequential_tests;
mod smooth;
mod vectors;

pub use quadratic::{QuadraticFault, QuadraticSolution, solve_quadratic};
pub use row::{FixedRows, Row, RowSource};
pub use sequential::{LinearLimits, Objective, Progress, Sequential, SequentialSettings};
pub use smooth::{SmoothLimits, SmoothRow, Together};
pub(super) use vectors::{dot, square};
