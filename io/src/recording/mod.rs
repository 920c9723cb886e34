//! Recordings as they are written: a sink for each format, and the notes of a recording.
//!
//! A recording streams into `R.mcap.part`, readable to its last chunk, and takes its name when the experiment is
//! complete. A part that is there is never
//! written over: it can be continued.

mod arm_view;
mod csv_sink;
mod file_sink;
mod mcap_sink;
mod notes;
mod part;
mod sink_thread;
mod torque_view;

pub use csv_sink::CsvSink;
pub use file_sink::FileSink;
pub use mcap_sink::McapSink;
pub(crate) use mcap_sink::{ENDING, LINKS, METADATA, STATES, VOLTAGE};
pub use notes::Notes;
pub use part::{check_at_rest, check_free, part_path};
pub use sink_thread::with_sink_thread;
pub use torque_view::TorqueView;
