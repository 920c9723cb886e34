//! Logs: positions and efforts of some joints from any recorder, and how they become samples.
//!
//! | file | holds |
//! |---|---|
//! | MCAP of `armid run` | the recording with its plan, its robot and its provenance |
//! | MCAP of other tools, or a folder of `ros2 bag` with files in MCAP or SQLite | `sensor_msgs/msg/JointState` on `/joint_states`, on the one topic that has them, or on the one that a [`Mapping`] states; the rate comes from the stamps |
//! | CSV of armid | `t,q1..qn,tau1..taun` (N·m) or `t,q1..qn,current1..currentn` (A) |
//! | tables of other tools, as text, in gzip, as Parquet or as arrays of NumPy (`.npy`, `.npz`) | any headings; a [`Mapping`] says what the columns are |
//! | a folder of LeRobot | frames of episodes; a [`Mapping`] says which features are positions and efforts |
//!
//! What something else recorded is brought onto an even grid, in segments without a break; what is left out on the way is
//! counted in its [`Origin`].

mod aperiodic_log;
mod arrangement;
mod arrays;
mod at_joints;
mod bag;
mod channels;
mod conversion;
mod csv;
mod cut;
mod effort_scale;
mod find;
mod foreign;
mod foreign_csv;
mod gaps;
mod gzip;
mod joint_log;
mod joint_names;
mod lerobot;
mod log_file;
mod log_format;
mod log_identification;
mod log_prediction;
mod log_report;
mod low_pass;
mod mapping;
mod mcap;
mod mcap_contents;
mod mcap_records;
mod npy;
mod origin;
mod parquet_table;
mod periodic_log;
mod processed_log;
mod processing;
mod raw_log;
mod reading;
mod recorded;
mod servo;
mod settings;
mod side_by_side;
mod sqlite;
mod stamps;
mod state_rows;
mod state_table;
mod states;
mod suspicions;
mod topics;
mod unusable;
mod used_part;

pub use armid::estimation::PositionServo as Servo;
pub use arrays::{ArrayTime, LogArrays};
pub use channels::{ChannelFault, ChannelState};
pub use csv::{parse as parse_csv, write as write_csv};
pub use effort_scale::EffortScale;
pub use find::{FoundLogs, find, is_joint_states, is_table};
pub use foreign_csv::parse as parse_tables;
pub use gaps::Gaps;
pub use joint_log::{Log, RecordedRobot, Segment};
pub use log_file::LogFile;
pub use log_prediction::LogResidual;
pub use log_report::LogReport;
pub use mapping::{ColumnMap, Mapping, Quantity, Unit};
pub use mcap::parse as parse_mcap;
pub(crate) use mcap_records::Records;
pub use origin::{FileHash, Origin};
pub use processed_log::ProcessedLog;
pub use processing::process_all;
pub use settings::{HeldOut, LogSettings};
pub use stamps::Timing;
