//! Studies on disk: the plan, the work as it gets done, and the results.

mod journal;
mod journal_text;
mod line_chain;
mod parameter_rows;
mod piece;
mod plan;
mod run_rows;
mod store;

pub use journal::Journal;
pub use journal_text::parse_journal;
pub use line_chain::LineChain;
pub use piece::Piece;
pub use plan::load as load_plan;
pub use store::{parse as parse_study, plan_text, read as read_study, write as write_study, write_timing};
