//! The optimiser: sequential quadratic programming whose rows are limits at the true extrema of the trajectory.

mod dual_active_set;
mod sequential;

pub use dual_active_set::{FixedRows, QuadraticFault, QuadraticSolution, Row, RowSource, solve_quadratic};
pub use sequential::{LinearLimits, Objective, Progress, Sequential, SequentialSettings, SmoothLimits, Unlimited};
