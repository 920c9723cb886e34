//! Measured joints.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

use super::Header;

/// `sensor_msgs/msg/JointState`: some joints at one time, in any order; a list may be empty where it is not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Positions, rad (m).
    pub position: Vec<f64>,
    /// Velocities, rad/s (m/s).
    pub velocity: Vec<f64>,
    /// Efforts, N·m (N), or motor currents, A, where the driver maps them onto effort.
    pub effort: Vec<f64>,
}

impl Message for JointState {}
