//! A motion as a list of points.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

use super::{Header, Time};

/// `trajectory_msgs/msg/JointTrajectoryPoint`; positions in the order of the trajectory's names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryPoint {
    /// Positions, rad (m).
    pub positions: Vec<f64>,
    /// Velocities, rad/s (m/s); may be empty.
    pub velocities: Vec<f64>,
    /// Accelerations, rad/s² (m/s²); may be empty.
    pub accelerations: Vec<f64>,
    /// Feed-forward efforts, N·m (N); may be empty.
    pub effort: Vec<f64>,
    /// When, after the trajectory's beginning.
    pub time_from_start: Time,
}

impl Message for TrajectoryPoint {}

/// `trajectory_msgs/msg/JointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTrajectory {
    /// When the motion begins, by the robot's clock; zero means at once.
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// The points in the order of time.
    pub points: Vec<TrajectoryPoint>,
}

impl Message for JointTrajectory {}
