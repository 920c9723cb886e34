//! Studies on disk: the plan, the work as it gets done, and the results.

mod figure_numbers;
mod finished_work;
mod journal;
mod journal_text;
mod line_chain;
mod number_file;
mod output_folder;
mod piece;
mod pilot;
mod plan;
mod robots;
mod row_files;
mod store;

pub use figure_numbers::{read_figure_numbers, write_figure_numbers};
pub use finished_work::{FinishedWork, MadeDesign};
pub use journal::Journal;
pub use journal_text::parse_journal;
pub use line_chain::LineChain;
pub use number_file::NumberFile;
pub use output_folder::{check_output, check_robots_output};
pub use piece::Piece;
pub use pilot::{RunErrors, RunValue, design_and_run_seconds, log_ratios, run_errors, run_values};
pub use plan::{load as load_plan, load_all as load_plans};
pub use robots::{read_robots, write_robots};
pub use row_files::RowFiles;
pub use store::{parse as parse_study, plan_text, read as read_study, write as write_study, write_provenance};
