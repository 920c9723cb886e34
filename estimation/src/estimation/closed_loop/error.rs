//! Why a closed loop cannot be simulated.

use crate::experiment::DivergenceError;

/// Why a closed loop cannot be simulated: what is missing and where it belongs, or where the motion ended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClosedLoopError {
    /// The problem was given no closed loop.
    #[error("nothing simulates the arm, expected a closed loop (EstimationProblem::with_closed_loop)")]
    NotGiven,
    /// Nothing states how the servo is tuned.
    #[error(
        "the servo of robot \"{robot}\" is not known, expected a table [servo] in its robot file with rate_hz, bandwidth_hz, \
         damping and integral_hz"
    )]
    NoServo {
        /// Name of the robot.
        robot: String,
    },
    /// The samples were not recorded along a motion that is known.
    #[error(
        "the motion that the servo was commanded is not known, expected a recording of armid's own, which holds it from rest to rest"
    )]
    NoReference,
    /// Nothing says on which inertia the servo's gains are placed.
    #[error(
        "robot \"{robot}\" has no nominal parameters, on whose inertia the gains of its servo are placed, expected nominal.toml \
         beside its robot file"
    )]
    NoNominal {
        /// Name of the robot.
        robot: String,
    },
    /// The simulator cannot simulate this robot or this plan.
    #[error("the arm cannot be simulated: {reason}")]
    Unsimulable {
        /// What it says.
        reason: String,
    },
    /// The simulated motion has another number of samples than the recording.
    #[error("{found} simulated samples, expected the recording's {expected}")]
    Samples {
        /// Simulated.
        found: usize,
        /// Recorded.
        expected: usize,
    },
    /// With these parameters the arm would accelerate against its torque.
    #[error("the mass matrix is not positive definite at t = {t:.3} s")]
    MassMatrix {
        /// Time since the beginning of the experiment, s.
        t: f64,
    },
    /// An observer ended the simulation.
    #[error("the simulation was interrupted")]
    Interrupted,
    /// With these parameters the servo does not hold the arm.
    #[error("the simulated motion runs away at t = {t:.3} s: {reason}")]
    Diverged {
        /// Time since the beginning of the experiment, s.
        t: f64,
        /// Why.
        reason: DivergenceError,
    },
}

impl ClosedLoopError {
    /// Whether other parameters may do: the trial point is at fault, nothing is missing.
    #[must_use]
    pub const fn is_of_parameters(&self) -> bool {
        matches!(self, Self::MassMatrix { .. } | Self::Diverged { .. })
    }
}
