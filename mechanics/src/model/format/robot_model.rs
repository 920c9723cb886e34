//! What a robot file states.

use super::collision::CollisionShape;
use crate::model::parameters::StandardParameters;
use crate::model::robot::Robot;

/// A robot, and what its file says of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotModel {
    /// The robot.
    pub robot: Robot,
    /// Inertias, friction and other terms that the file and its URDF state; `None` where there is no URDF.
    pub parameters: Option<StandardParameters>,
    /// Joints of the URDF that the chain does not have, held at zero.
    pub locked: Vec<String>,
    /// Collision shapes of the URDF; [`Robot::shapes`] has those of the robot file alone.
    pub collisions: Vec<CollisionShape>,
    /// What else was read otherwise than it is written, a sentence each.
    pub remarks: Vec<String>,
}
