//! What is shown of estimates and studies, as pages.

mod comparison;
mod estimate_page;
mod log_figures;
mod page;
mod study_page;
mod thinning;
mod torque_comparison;

pub use armid_reports::Sheet;
pub use comparison::{ComparisonAnswer, write_comparison};
pub use estimate_page::EstimatePage;
pub use log_figures::LogFigures;
pub use study_page::{write_criteria, write_levels, write_report, write_robots_report};
pub use torque_comparison::TorqueComparison;
