//! What a guard did and observed: part of the recording's metadata.

use std::collections::BTreeMap;

use armid::experiment::TripReport;

use super::{GuardSettings, Mode};

/// What a guard did and saw during one experiment.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct GuardRecord {
    /// How the motion reached the robot.
    pub mode: Mode,
    /// Whether the request `disable` has a subscriber; otherwise such a trip ends the motion.
    pub disables: bool,
    /// The limits of the checks.
    pub settings: GuardSettings,
    /// States per second that the bounds of the checks count with, Hz.
    pub rate_hz: f64,
    /// What was checked before the first motion, in order.
    pub preflight: Vec<Passed>,
    /// How the arm came to the start pose; absent where it stands there by itself.
    pub approach: Option<ApproachRecord>,
    /// Largest part of its limit that each check used; 1 trips.
    pub used: BTreeMap<&'static str, f64>,
    /// Why it tripped, where it did.
    pub trip: Option<TripReport>,
}

/// One passed check of the preflight.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Passed {
    /// Name of the check.
    pub check: &'static str,
    /// What was found.
    pub found: String,
}

/// How the arm came to the start pose.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ApproachRecord {
    /// Where it stood, rad (m).
    pub from: Vec<f64>,
    /// The start pose, rad (m).
    pub to: Vec<f64>,
    /// How long it took by plan, s.
    pub duration_s: f64,
}

impl GuardRecord {
    pub(super) fn new(settings: &GuardSettings, mode: Mode) -> Self {
        let (preflight, used) = (Vec::new(), BTreeMap::new());
        let settings = settings.clone();
        Self { mode, disables: true, settings, rate_hz: 0.0, preflight, approach: None, used, trip: None }
    }
}
