//! The optimiser: sequential quadratic programming whose rows are limits at the true extrema of the trajectory.

mod dual_active_set;

pub use dual_active_set::{FixedRows, QuadraticFault, QuadraticSolution, Row, RowSource, solve_quadratic};
