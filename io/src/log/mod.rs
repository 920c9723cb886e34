//! Logs: positions and efforts of some joints from any recorder, and how they become samples.
//!
//! | file | holds |
//! |---|---|
//! | MCAP of `armid run` | the recording with its plan, its robot and its provenance |
//! | MCAP of other tools | `sensor_msgs/msg/JointState` on `/joint_states`; the rate comes from the stamps |
//! | CSV | `t,q1..qn,tau1..taun` (N·m) or `t,q1..qn,current1..currentn` (A) |

mod csv;
mod foreign;
mod gaps;
mod joint_log;
mod mcap;
mod mcap_records;
mod processing;
mod recorded;
mod state_table;

pub use csv::{parse as parse_csv, write as write_csv};
pub use gaps::Gaps;
pub use joint_log::{Log, RecordedRobot};
pub use mcap::parse as parse_mcap;
pub(crate) use mcap_records::Records;
pub use processing::{LogSettings, ProcessedLog};
