//! The link to a robot over ROS 2: joint states in, a motion out, by DDS alone.
//!
//! ```text
//!  robot controller                                        armid
//!  joint_states ──→ names mapped ─→ stamps checked ─→ resampled onto the plan's grid ─→ Sink
//!  action, topic or set-points ←── Motion                 (StampFindings)
//! ```
//! The time of a sample is the stamp in its header, by the robot's clock; how long nothing was received is measured by the
//! local monotonic clock. The motion begins at a stamp of the robot's clock that the link chooses and sends along. How fast
//! the robot's clock runs is watched by ours (`clock.rs`).

mod clock;
mod connection;
mod error;
mod follow;
mod halt;
mod joint_map;
#[cfg(test)]
mod loopback_tests;
mod motion;
mod network;
mod node;
mod pieces;
mod resample;
mod rest;
mod ros2_arm;
mod sender;
mod settings;
mod stamps;
mod states;

pub use error::LinkError;
pub(crate) use follow::Listener;
pub use joint_map::{JointMap, JointRow};
pub use motion::{Motion, PlanMotion};
pub use node::{Endpoint, peers};
pub use pieces::{Piece, piece, points};
pub use resample::{GridSample, Resampler};
pub(crate) use ros2_arm::ending;
pub use ros2_arm::{Reading, Ros2Arm, look};
pub use settings::{LinkSettings, Mode, Network, ServiceMappingName};
pub use stamps::{StampFindings, StampWatch};
pub(crate) use states::Inbox;
