//! What is shown of estimates and studies, as pages.

mod comparison;
mod estimate_page;
mod page;
mod study_page;

pub use armid_reports::Sheet;
pub use comparison::{ComparisonAnswer, write_comparison};
pub use estimate_page::{TorqueComparison, write_estimate_report};
pub use study_page::{write_criteria, write_levels, write_report, write_robots_report};
