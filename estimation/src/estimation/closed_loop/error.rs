//! Why a closed loop cannot be simulated.

use crate::experiment::DivergenceError;

/// Why a closed loop cannot be simulated: what is missing and where it belongs, or where the motion ended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ClosedLoopError {
    /// The problem was given no closed loop.
    #[error("nothing simulates the arm, expected a closed loop (EstimationProblem::closed_loop)")]
    NotGiven,
    /// Nothing states how the servo is tuned.
    #[error(
        "the servo of robot \"{robot}\" is not known, expected a table [servo] in its robot file with rate_hz, bandwidth_hz, \
         damping and integral_hz"
    )]
    NoServo { robot: String },
    /// The samples were not recorded along a motion that is known.
    #[error(
        "the motion that the servo was commanded is not known, expected a recording of armid's own, which holds it from rest to rest, or \
         a log of commanded positions"
    )]
    NoReference,
    /// The estimator needs servos that are known.
    #[error("{} of the servo is to be estimated, which positions alone show, expected the estimator cloe", parts.join(", "))]
    ServoUnknown { parts: Vec<String> },
    /// The motion does not show a number of a servo: what moves the arm alike is in `with`, which is empty where the number does not move it.
    #[error("{}", hidden_servo(part, with))]
    ServoHidden { part: String, with: Vec<String> },
    /// A log of commands has a gap, behind which nothing says where the arm is.
    #[error("the log of commands is in {segments} parts with gaps between them, expected one without a gap")]
    Gaps { segments: usize },
    /// Nothing says on which inertia the servo's gains are placed.
    #[error(
        "robot \"{robot}\" has no nominal parameters, on whose inertia the gains of its servo are placed, expected nominal.toml \
         beside its robot file"
    )]
    NoNominal { robot: String },
    /// The simulator cannot simulate this robot or this plan.
    #[error("the arm cannot be simulated: {reason}")]
    Unsimulable { reason: String },
    /// The simulated motion has another number of samples than the recording.
    #[error("{found} simulated samples, expected the recording's {expected}")]
    Samples { found: usize, expected: usize },
    /// With these parameters the arm would accelerate against its torque.
    #[error("the mass matrix is not positive definite at t = {t:.3} s")]
    MassMatrix { t: f64 },
    /// An observer ended the simulation.
    #[error("the simulation was interrupted")]
    Interrupted,
    /// With these parameters the servo does not hold the arm.
    #[error("the simulated motion runs away at t = {t:.3} s: {reason}")]
    Diverged { t: f64, reason: DivergenceError },
}

/// Why a number of a servo cannot be estimated, and what to do.
fn hidden_servo(part: &str, with: &[String]) -> String {
    const LISTED: usize = 6;
    let shown = match with {
        [] => {
            return format!(
                "the motion does not show {part} of the servo: no position depends on it, expected it to be stated"
            );
        }
        [one] => one.clone(),
        few if few.len() <= LISTED => few.join(", "),
        many => format!("{} and {} others", many[..LISTED].join(", "), many.len() - LISTED),
    };
    let scale = part.starts_with("kp") && with.len() > 1;
    let advice = if scale { "a stated kp of one joint, or a known payload" } else { "it to be stated" };
    format!("the motion does not show {part} of the servo: it moves the arm as {shown} can, expected {advice}")
}

impl ClosedLoopError {
    /// Whether other parameters may do: the trial point is at fault, nothing is missing.
    pub const fn is_of_parameters(&self) -> bool {
        matches!(self, Self::MassMatrix { .. } | Self::Diverged { .. })
    }
}
