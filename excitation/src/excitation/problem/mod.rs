//! What is asked of a design: where it is sought, what it must hold, what makes it good, and how long the search may take.
//!
//! Each part is checked where it is made, and against the robot and the other parts where the problem takes it. What a
//! [`DesignProblem`] holds is possible: a search on it fails for no setting.

mod budget;
mod definition;
mod limits;
mod objective;
mod space;

pub use budget::{DEFAULT_EVALUATIONS, DesignBudget};
pub use definition::DesignProblem;
pub use limits::{DesignLimits, LimitSettings};
pub use objective::DesignObjective;
pub use space::DesignSpace;
