//! Recordings as they are written: a sink for each format, and the notes of a recording.
//!
//! A recording streams into `R.mcap.part`, readable to its last chunk, and takes its name when the experiment is
//! complete.

mod csv_sink;
mod file_sink;
mod mcap_sink;
mod notes;
mod sink_thread;

pub use csv_sink::CsvSink;
pub use file_sink::{FileSink, part_of};
pub use mcap_sink::McapSink;
pub(crate) use mcap_sink::{ENDING, METADATA, STATES, VOLTAGE};
pub use notes::Notes;
pub use sink_thread::beside;
