//! Why a run gave no estimate: a kind that can be counted, and the reason in words.

use crate::experiment::{ArmError, DivergenceError, PlantError, TripReport};

/// Why a run, or one estimator of it, gave no estimate.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[error("{reason}")]
pub struct RunError {
    /// Its kind.
    pub kind: RunErrorKind,
    /// What happened, with numbers.
    pub reason: String,
}

/// The kinds of failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunErrorKind {
    /// The arm could not begin.
    Arm,
    /// A coordinate or velocity was no longer a number.
    DivergedNotFinite,
    /// A joint was faster than ten times its limit.
    DivergedSpeed,
    /// The engine failed.
    DivergedEngine,
    /// A guard ended the experiment.
    Tripped,
    /// The recording could not be processed.
    Signal,
    /// The estimator gave no estimate.
    Estimator,
}

crate::input::named! { RunErrorKind {
    Arm: "arm", DivergedNotFinite: "diverged-not-finite", DivergedSpeed: "diverged-speed",
    DivergedEngine: "diverged-engine", Tripped: "tripped", Signal: "signal", Estimator: "estimator"
} }

impl RunError {
    /// An arm that could not begin.
    #[must_use]
    pub fn arm(fault: &ArmError) -> Self {
        Self { kind: RunErrorKind::Arm, reason: format!("arm: {fault}") }
    }

    /// A motion that diverged at time `t`, s.
    #[must_use]
    pub fn diverged(t: f64, divergence: &DivergenceError) -> Self {
        let kind = match divergence {
            DivergenceError::Speed { .. } => RunErrorKind::DivergedSpeed,
            DivergenceError::Plant(PlantError::NotFinite { .. }) => RunErrorKind::DivergedNotFinite,
            DivergenceError::Plant(PlantError::Engine { .. }) => RunErrorKind::DivergedEngine,
        };
        Self { kind, reason: format!("diverged at t = {t:.3} s: {divergence}") }
    }

    /// A guard that ended the experiment at time `t`, s.
    #[must_use]
    pub fn tripped(t: f64, trip: &TripReport) -> Self {
        Self { kind: RunErrorKind::Tripped, reason: format!("tripped at t = {t:.3} s: {trip}") }
    }

    /// A recording that could not be processed.
    #[must_use]
    pub fn signal(fault: &impl std::fmt::Display) -> Self {
        Self { kind: RunErrorKind::Signal, reason: format!("signal: {fault}") }
    }

    /// An estimator that gave nothing.
    #[must_use]
    pub fn estimator(fault: &impl std::fmt::Display) -> Self {
        Self { kind: RunErrorKind::Estimator, reason: fault.to_string() }
    }
}
