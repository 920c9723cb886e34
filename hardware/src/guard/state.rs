//! The state that a guard publishes during a run, for monitors.

use std::collections::BTreeMap;

use armid::experiment::{Phase, TripReport};

use super::Mode;

/// What a guard is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Activity {
    /// The arm is on its way to the start pose.
    Approach,
    /// The experiment is under way.
    Experiment,
    /// It is over.
    Ended,
}

impl Activity {
    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Experiment => "experiment",
            Self::Ended => "ended",
        }
    }
}

/// One look at a guard.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GuardState {
    /// How the motion reaches the robot.
    pub mode: Mode,
    /// What it is doing.
    pub doing: Activity,
    /// Phase of the last sample.
    pub phase: Phase,
    /// Time of the last sample, s.
    pub t_s: f64,
    /// Largest part of its limit that each check used so far; 1 trips.
    pub used: BTreeMap<String, f64>,
    /// Why it tripped, in words, where it did.
    pub trip: Option<String>,
}

/// Receives the state of a guard, at most every tenth of a second of the experiment's time, and once at the end.
pub type Observer = Box<dyn FnMut(&GuardState) + Send>;

/// How often a guard reports its state, s.
pub(super) const TELL_EVERY_S: f64 = 0.1;

impl GuardState {
    pub(super) fn new(mode: Mode, doing: Activity, (t_s, phase): (f64, Phase), watch: &super::Watch) -> Self {
        let used = watch.used().into_iter().map(|(trip, used)| (trip.name().to_owned(), used)).collect();
        Self { mode, doing, phase, t_s, used, trip: watch.tripped().map(TripReport::to_string) }
    }
}
