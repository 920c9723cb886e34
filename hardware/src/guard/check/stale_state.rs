//! Joint states that do not arrive, or arrive late.

use armid::experiment::RawSample;

use super::Check;
use crate::guard::Trip;

/// Trips where no state came for longer than the limit, or one was on its way for longer than that: by the local clock
/// while the silence lasts, and by the robot's own stamps where one gap lies between two states that arrive together.
pub(super) struct StaleState {
    line_s: f64,
    before: Option<f64>,
    used: f64,
}

impl StaleState {
    pub(super) fn new(line_s: f64) -> Self {
        Self { line_s, before: None, used: 0.0 }
    }

    fn look(&mut self, what: &str, age_s: f64) -> Option<String> {
        self.used = self.used.max(age_s / self.line_s);
        let (found, line) = (1e3 * age_s, 1e3 * self.line_s);
        (age_s > self.line_s).then(|| format!("{what} {found:.1} ms, expected at most {line:.1} ms"))
    }
}

impl Check for StaleState {
    fn trip(&self) -> Trip {
        Trip::StaleState
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let gap = self.before.map_or(0.0, |before| sample.t - before);
        self.before = Some(sample.t);
        self.look("two states are apart by", gap)
    }

    fn idle(&mut self, age_s: f64) -> Option<String> {
        self.look("the age of the state is", age_s)
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
