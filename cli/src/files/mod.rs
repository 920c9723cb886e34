//! The files that the command reads and writes.

pub(crate) mod experiment_toml;
pub(crate) mod file_sink;
pub(crate) mod float_array;
pub(crate) mod joint_state;
pub(crate) mod journal;
pub(crate) mod log;
mod mcap_records;
pub(crate) mod number_table;
pub(crate) mod parquet_table;
pub(crate) mod prior;
pub(crate) mod recording_csv;
pub(crate) mod recording_mcap;
pub(crate) mod recording_notes;
pub(crate) mod recording_reader;
pub(crate) mod sink_thread;
pub(crate) mod states_csv;
pub(crate) mod study_store;
pub(crate) mod trajectory;
