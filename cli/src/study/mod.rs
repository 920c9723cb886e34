//! Studies being performed, here or by a cluster.

pub(crate) mod cluster;
mod part;
mod performance;
mod report;

pub(crate) use part::{Part, Shard, Stage, stored_designs};
pub(crate) use performance::{Performance, Prepared, in_words};
pub(crate) use report::write_report;
