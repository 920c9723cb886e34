//! Studies on disk: the plan, the work as it gets done, and the results.

mod journal;
mod parameter_rows;
mod plan;
mod run_rows;
mod store;

pub use journal::{Journal, Piece};
pub use plan::load as load_plan;
pub use store::{plan_text, read as read_study, write as write_study, write_timing};
