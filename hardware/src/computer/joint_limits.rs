//! What the joints of a robot may be commanded.

use armid::model::Robot;

/// What a joint may be commanded.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits {
    /// Its name.
    pub name: String,
    /// Positions, rad (m).
    pub position: (f64, f64),
    /// Speed, rad/s (m/s).
    pub velocity: f64,
    /// Acceleration, rad/s² (m/s²).
    pub acceleration: f64,
}

impl JointLimits {
    /// The limits of a robot's joints.
    pub fn of_robot(robot: &Robot) -> Vec<Self> {
        let of = |joint: &armid::model::Joint| Self {
            name: joint.name.clone(),
            position: joint.limits.position,
            velocity: joint.limits.velocity,
            acceleration: joint.limits.acceleration,
        };
        robot.joints().iter().map(of).collect()
    }
}
