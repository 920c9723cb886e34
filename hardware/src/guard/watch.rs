//! All checks of one run; a trip is latched.

use armid::experiment::{RawSample, ReceivedState, Rest, SafeAction, TripReport};
use armid::model::Robot;

use super::check::{self, Check};
use super::{GuardSettings, JointBounds, Mode, Trip};

/// Judges what happens from an arm's first motion to its last. Once it has tripped it stays tripped: every later
/// question gets the same answer.
pub struct Watch {
    checks: Vec<Box<dyn Check>>,
    /// Largest part of its limit that each check used.
    used: Vec<f64>,
    settings: GuardSettings,
    mode: Mode,
    rate_hz: f64,
    disables: bool,
    tripped: Option<TripReport>,
}

impl Watch {
    /// A watch over motions whose states come at `rate_hz`.
    pub fn new(robot: &Robot, bounds: &[JointBounds], settings: &GuardSettings, mode: Mode, rate_hz: f64) -> Self {
        let checks = check::all(robot, bounds, settings, mode, rate_hz);
        let (used, settings) = (vec![0.0; checks.len()], settings.clone());
        Self { used, checks, settings, mode, rate_hz, disables: true, tripped: None }
    }

    /// Returns this watch, which ends the motion instead of switching the drives off where nothing `disables` them.
    #[must_use]
    pub(super) fn with_disable(mut self, disables: bool) -> Self {
        self.disables = disables;
        self
    }

    /// Judges a sample.
    pub fn sample(&mut self, sample: &RawSample<'_>) -> Option<&TripReport> {
        self.judge(|check| check.sample(sample))
    }

    /// Judges a joint state as it arrives.
    pub fn received(&mut self, state: &ReceivedState<'_>) -> Option<&TripReport> {
        self.judge(|check| check.received(state))
    }

    /// Judges a silence of `age_s`.
    pub fn idle(&mut self, age_s: f64) -> Option<&TripReport> {
        self.judge(|check| check.idle(age_s))
    }

    /// Judges a set-point that was due `age_s` ago.
    pub fn command(&mut self, set_point: &[f64], age_s: f64) -> Option<&TripReport> {
        self.judge(|check| check.command(set_point, age_s))
    }

    /// Why it tripped.
    pub fn tripped(&self) -> Option<&TripReport> {
        self.tripped.as_ref()
    }

    /// Largest part of its limit that each check used since the beginning, or since [`Watch::reset_used`].
    pub fn used(&self) -> Vec<(Trip, f64)> {
        self.checks.iter().zip(&self.used).map(|(check, used)| (check.trip(), *used)).collect()
    }

    /// Counts anew how much of its limit each check uses; what the checks have seen stays.
    pub fn reset_used(&mut self) {
        self.used.fill(0.0);
    }

    fn judge(&mut self, mut ask: impl FnMut(&mut dyn Check) -> Option<String>) -> Option<&TripReport> {
        if self.tripped.is_none() {
            // The first finding wins, in the order of the list: what is not a number never reaches another check.
            let found = self.checks.iter_mut().find_map(|check| ask(&mut **check).map(|reason| (check.trip(), reason)));
            for (used, check) in self.used.iter_mut().zip(&mut self.checks) {
                *used = used.max(check.take_used());
            }
            self.tripped = found.map(|(trip, reason)| {
                let mut report = report(trip, reason, &self.settings, self.mode, self.rate_hz);
                if report.action == SafeAction::Disable && !self.disables {
                    report.action = Trip::mildest(self.mode);
                }
                report
            });
        }
        self.tripped.as_ref()
    }
}

/// What a trip is to the reader of the recording, before it is known what came of its action.
pub(super) fn report(trip: Trip, reason: String, settings: &GuardSettings, mode: Mode, rate_hz: f64) -> TripReport {
    let rest = Rest::NotConfirmed { reason: "not observed yet".to_owned() };
    let bound_ms = trip.bound_ms(settings, rate_hz);
    TripReport { trip: trip.name(), action: trip.action(mode), bound_ms, reason, rest }
}
