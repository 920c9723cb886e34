//! The files of armid as values: logs, recordings, robots, trajectories, experiments, estimates and stored studies.
#![forbid(unsafe_code)]

pub mod bundled_experiments;
pub mod error;
pub mod estimate;
pub mod experiment;
pub mod log;
pub mod message;
pub mod output;
pub mod prior;
pub mod recording;
pub mod robot;
pub mod study;
pub mod suggestion;
pub mod table;
pub mod text;
pub mod trajectory;

pub use error::{Error, ErrorKind};
pub use experiment::Experiment;
pub use log::{Log, LogSettings, ProcessedLog};
pub use robot::LoadedRobot;
pub use text::Text;
