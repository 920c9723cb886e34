//! Studies being performed, here or by a cluster.

pub(crate) mod cluster;
mod forecast;
mod part;
mod performance;
mod prepared;
mod report;
mod summary;
mod team;
mod until;
mod words;

pub(crate) use forecast::{Forecast, sample_plan};
pub(crate) use part::{Part, Shard, Stage};
pub(crate) use performance::Performance;
pub(crate) use prepared::Prepared;
pub(crate) use report::{write_criteria, write_report, write_robots_report};
pub(crate) use words::in_words;
