//! Why a robot cannot be simulated by this engine.

use armid::dynamics::TermError;
use armid::spatial::InertiaError;

/// Why a robot cannot be simulated by this engine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RapierError {
    /// The parameters are of another robot.
    #[error("the parameters are of {found} links, expected the robot's {expected}")]
    Parameters {
        /// Number of links they describe.
        found: usize,
        /// Number of joints of the robot.
        expected: usize,
    },
    /// A physically inconsistent link: the engine would drop what is negative and go on.
    #[error("link {link}: {fault}")]
    Link {
        /// Number of the link, from one.
        link: usize,
        /// What is wrong with it.
        fault: InertiaError,
    },
    /// A rotor with negative inertia.
    #[error("joint \"{joint}\": rotor inertia is {rotor} kg·m², expected zero or more")]
    Rotor {
        /// Name of the joint.
        joint: String,
        /// What was found.
        rotor: f64,
    },
    /// A torque term that the engine cannot simulate.
    #[error(transparent)]
    Term(#[from] TermError),
}
