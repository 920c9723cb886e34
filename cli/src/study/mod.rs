//! Studies being performed.

mod performance;
mod report;

pub(crate) use performance::{Prepared, Shard, in_words};
pub(crate) use report::write_report;
