//! ROS 2 messages that recordings hold, as bytes.

pub mod float_array;
pub mod joint_state;
