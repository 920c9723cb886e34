//! What a check is, and the list of all.

use armid::experiment::{RawSample, ReceivedState};
use armid::model::Robot;

use super::{
    CommandAge, CommandStep, CurrentClamp, FollowingError, NotFinite, Overspeed, PositionJump, ReducedSpeed, SoftLimit,
    StaleState, UnexpectedStop,
};
use crate::guard::{GuardSettings, JointBounds, Mode, Trip};

/// Watches for one kind of fault. It receives what happens and answers with what it found, where that is too much.
///
/// Checks have no clock: time is the samples' own, and silences and arrivals are reported to them.
pub trait Check: Send {
    /// Which trip it causes.
    fn trip(&self) -> Trip;

    /// Takes a sample; finite unless this is the check that looks for that.
    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let _ = sample;
        None
    }

    /// Takes a joint state as it arrives, before the samples that follow from it.
    fn received(&mut self, state: &ReceivedState<'_>) -> Option<String> {
        let _ = state;
        None
    }

    /// Takes that no sample has come for `age_s`.
    fn idle(&mut self, age_s: f64) -> Option<String> {
        let _ = age_s;
        None
    }

    /// Takes a set-point before it is sent, `age_s` after it was due.
    fn command(&mut self, set_point: &[f64], age_s: f64) -> Option<String> {
        let _ = (set_point, age_s);
        None
    }

    /// Largest part of its limit that was used since this was asked last: 1 where it trips.
    fn take_used(&mut self) -> f64;
}

/// Every check of a mode, in the order of [`Trip::ALL`]. What the link or the robot controller reports is not watched for
/// here.
pub(crate) fn all(
    robot: &Robot,
    bounds: &[JointBounds],
    settings: &GuardSettings,
    mode: Mode,
    rate_hz: f64,
) -> Vec<Box<dyn Check>> {
    let period_s = 1.0 / rate_hz;
    let every: [Box<dyn Check>; 11] = [
        Box::new(NotFinite::new(bounds)),
        Box::new(PositionJump::new(bounds, period_s)),
        Box::new(SoftLimit::new(bounds)),
        Box::new(Overspeed::new(bounds)),
        Box::new(ReducedSpeed::new(robot, settings.reduced_speed_mm_s)),
        Box::new(FollowingError::new(bounds)),
        Box::new(CurrentClamp::new(bounds, settings.current_window_ms * 1e-3)),
        Box::new(UnexpectedStop::new(bounds, settings.stop_window_ms * 1e-3)),
        Box::new(StaleState::new(settings.stale_ms * 1e-3)),
        Box::new(CommandAge::new(settings.command_age_ms * 1e-3)),
        Box::new(CommandStep::new(bounds, period_s + settings.command_age_ms * 1e-3)),
    ];
    every.into_iter().filter(|check| check.trip().exists_in(mode)).collect()
}
