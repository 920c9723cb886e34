//! The optimiser: sequential quadratic programming whose rows are limits at the true extrema of the trajectory.

mod active_set;
mod factor;
mod quadratic;
#[cfg(test)]
mod quadratic_tests;
mod row;
mod sequential;
mod vectors;

pub use quadratic::{QuadraticFault, QuadraticSolution, solve_quadratic};
pub use row::{FixedRows, Row, RowSource};
pub use sequential::{LinearLimits, Objective, Progress, Sequential, SequentialSettings, SmoothLimits, Together};
