//! Why a servo cannot be built.

/// Why a servo cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ServoError {
    /// Plant, parameters and robot do not belong together.
    #[error("{quantity} has {found} joints, expected the robot's {expected}")]
    Dof { quantity: &'static str, found: usize, expected: usize },
    /// The nominal parameters give a motor no inertia to place gains on.
    #[error("motor of joint \"{joint}\": nominal inertia is {inertia} kg·m² at the gain pose, expected above zero")]
    Inertia { joint: String, inertia: f64 },
}
