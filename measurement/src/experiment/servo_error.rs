//! Why a servo cannot be built.

/// Why a servo cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ServoError {
    /// Plant, parameters and robot do not belong together.
    #[error("{quantity} has {found} joints, expected the robot's {expected}")]
    Dof {
        /// What does not fit.
        quantity: &'static str,
        /// Its number of joints.
        found: usize,
        /// The robot's.
        expected: usize,
    },
    /// The nominal parameters give a motor no inertia to place gains on.
    #[error("motor of joint \"{joint}\": nominal inertia is {inertia} kg·m² at the gain pose, expected above zero")]
    Inertia {
        /// Name of the joint.
        joint: String,
        /// What was found.
        inertia: f64,
    },
}
