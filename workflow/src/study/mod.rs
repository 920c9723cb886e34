//! How is a Monte Carlo study performed, stored and summed up?
//!
//! Designs and runs are made on all cores. Each is kept in a journal as soon as it is finished, so that work goes on after any
//! end, and the journals of parts are put together. Equal plans give equal bytes of every result.

mod answer;
mod looks;
mod part;
mod perform;
mod performance;
mod prepared;
mod robots;
mod settings;
mod summary;
mod team;
mod until;

pub use answer::{RobotsAnswer, StudyAnswer, StudySummary};
pub use looks::Looks;
pub use part::{Part, Shard, Stage};
pub use perform::{merge, perform};
pub use prepared::PreparedStudy;
pub use settings::StudySettings;
