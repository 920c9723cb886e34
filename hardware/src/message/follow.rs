//! The action by which a trajectory is handed over whole.

use ros2_client::Message;
use serde::{Deserialize, Serialize};

use super::{Header, JointTrajectory, MultiDofPoint, MultiDofTrajectory, Time, TrajectoryPoint};

/// `control_msgs/msg/JointTolerance`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTolerance {
    /// Name of the joint.
    pub name: String,
    /// Of position, rad (m); 0 for the controller's own, below 0 for none.
    pub position: f64,
    /// Of velocity, rad/s (m/s).
    pub velocity: f64,
    /// Of acceleration, rad/s² (m/s²).
    pub acceleration: f64,
}

/// `control_msgs/msg/JointComponentTolerance`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointComponentTolerance {
    /// Name of the joint.
    pub joint_name: String,
    /// Which component of it.
    pub component: u16,
    /// Of position.
    pub position: f64,
    /// Of velocity.
    pub velocity: f64,
    /// Of acceleration.
    pub acceleration: f64,
}

/// The goal of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FollowGoal {
    /// The motion.
    pub trajectory: JointTrajectory,
    /// Empty for an arm.
    pub multi_dof_trajectory: MultiDofTrajectory,
    /// How far the joints may be from the motion on the way.
    pub path_tolerance: Vec<JointTolerance>,
    /// Empty for an arm.
    pub component_path_tolerance: Vec<JointComponentTolerance>,
    /// How far they may be at the end.
    pub goal_tolerance: Vec<JointTolerance>,
    /// Empty for an arm.
    pub component_goal_tolerance: Vec<JointComponentTolerance>,
    /// How late the end may be.
    pub goal_time_tolerance: Time,
}

impl Message for FollowGoal {}

/// The result of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FollowResult {
    /// [`FollowResult::SUCCESSFUL`] or one of the others.
    pub error_code: i32,
    /// What went wrong.
    pub error_string: String,
}

impl Message for FollowResult {}

impl FollowResult {
    /// The motion was performed.
    pub const SUCCESSFUL: i32 = 0;
    /// The goal makes no sense.
    pub const INVALID_GOAL: i32 = -1;
    /// The goal names joints that are not there.
    pub const INVALID_JOINTS: i32 = -2;
    /// The goal begins before now.
    pub const OLD_HEADER_TIMESTAMP: i32 = -3;
    /// A joint was too far from the motion.
    pub const PATH_TOLERANCE_VIOLATED: i32 = -4;
    /// A joint was too far from the end.
    pub const GOAL_TOLERANCE_VIOLATED: i32 = -5;
}

/// The feedback of `control_msgs/action/FollowJointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FollowFeedback {
    /// When.
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// What is commanded.
    pub desired: TrajectoryPoint,
    /// What is measured.
    pub actual: TrajectoryPoint,
    /// The difference.
    pub error: TrajectoryPoint,
    /// Empty for an arm.
    pub multi_dof_joint_names: Vec<String>,
    /// Empty for an arm.
    pub multi_dof_desired: MultiDofPoint,
    /// Empty for an arm.
    pub multi_dof_actual: MultiDofPoint,
    /// Empty for an arm.
    pub multi_dof_error: MultiDofPoint,
}

impl Message for FollowFeedback {}
