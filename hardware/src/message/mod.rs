//! The ROS 2 messages of the link, written by hand: fields in the order of their definitions, so that their
//! CDR bytes are those of any other ROS 2 program.
//!
//! | here | in ROS 2 |
//! |---|---|
//! | [`Time`], [`Header`] | `builtin_interfaces/msg/Time`, `std_msgs/msg/Header` |
//! | [`JointState`] | `sensor_msgs/msg/JointState` |
//! | [`JointTrajectory`] | `trajectory_msgs/msg/JointTrajectory` |
//! | [`FollowGoal`], [`FollowFeedback`], [`FollowResult`] | `control_msgs/action/FollowJointTrajectory` |
//! | [`Float64MultiArray`], [`Text`] | `std_msgs/msg/Float64MultiArray`, `std_msgs/msg/String` |

mod array;
mod follow;
mod header;
mod joint_state;
mod multi_dof;
#[cfg(test)]
mod tests;
mod text;
mod trajectory;

pub use armid_cdr::Time;
pub use array::{ArrayDimension, ArrayLayout, Float64MultiArray};
pub use follow::{FollowFeedback, FollowGoal, FollowResult, JointComponentTolerance, JointTolerance};
pub use header::Header;
pub use joint_state::JointState;
pub use multi_dof::{MultiDofPoint, MultiDofTrajectory, Quaternion, Transform, Twist, Vector3};
pub use text::Text;
pub use trajectory::{JointTrajectory, TrajectoryPoint};
