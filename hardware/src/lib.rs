//! The real arm: its ROS 2 interface, the guard that every command passes, and a simulated robot controller.
//!
//! Nothing else in armid can move a real arm, and nothing here moves one except through the guard.
#![forbid(unsafe_code)]

pub mod computer;
pub mod guard;
pub mod link;
pub mod message;
pub mod monitor;
mod ros2;

pub use ros2::{GUARD_STATE, GuardedRos2, guarded_ros2};
