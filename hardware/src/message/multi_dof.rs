//! The part of `FollowJointTrajectory` for joints of several degrees of freedom. An arm has none: it goes out empty, but
//! its bytes must be read.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

use super::{Header, Time};

/// `geometry_msgs/msg/Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

/// `geometry_msgs/msg/Quaternion`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// Of i.
    pub x: f64,
    /// Of j.
    pub y: f64,
    /// Of k.
    pub z: f64,
    /// The real part.
    pub w: f64,
}

/// `geometry_msgs/msg/Transform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Translation, m.
    pub translation: Vector3,
    /// Rotation.
    pub rotation: Quaternion,
}

/// `geometry_msgs/msg/Twist`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Linear part, m/s.
    pub linear: Vector3,
    /// Angular part, rad/s.
    pub angular: Vector3,
}

/// `trajectory_msgs/msg/MultiDOFJointTrajectoryPoint`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MultiDofPoint {
    /// Poses.
    pub transforms: Vec<Transform>,
    /// Velocities.
    pub velocities: Vec<Twist>,
    /// Accelerations.
    pub accelerations: Vec<Twist>,
    /// When.
    pub time_from_start: Time,
}

/// `trajectory_msgs/msg/MultiDOFJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MultiDofTrajectory {
    /// When the motion begins.
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// The points in the order of time.
    pub points: Vec<MultiDofPoint>,
}

impl Message for MultiDofTrajectory {}
