//! Why a robot cannot be simulated by this engine.

use armid::dynamics::TermError;
use armid::spatial::InertiaError;

/// Why a robot cannot be simulated by this engine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum RapierError {
    /// The parameters are of another robot.
    #[error("the parameters are of {found} links, expected the robot's {expected}")]
    Parameters { found: usize, expected: usize },
    /// A physically inconsistent link: the engine would drop what is negative and go on.
    #[error("link {link}: {fault}")]
    Link { link: usize, fault: InertiaError },
    /// A rotor with negative inertia.
    #[error("joint \"{joint}\": rotor inertia is {rotor} kg·m², expected zero or more")]
    Rotor { joint: String, rotor: f64 },
    /// A torque term that the engine cannot simulate.
    #[error(transparent)]
    Term(#[from] TermError),
}
