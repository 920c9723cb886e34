//! A flange that is faster than a person beside the arm allows.

use std::collections::VecDeque;

use armid::experiment::RawSample;
use armid::model::Robot;

use super::Check;
use crate::guard::Trip;
use crate::guard::flange::{distance, flange};

/// Trips where the flange went further in a window W than its line allows, `|p(t) − p(t − W)| / W > v`, where a line is set.
pub(super) struct ReducedSpeed {
    robot: Robot,
    /// m/s; infinite where none is set.
    line: f64,
    window_s: f64,
    past: VecDeque<(f64, [f64; 3])>,
    used: f64,
}

impl ReducedSpeed {
    /// `line_mm_s` of 0 sets none.
    pub(super) fn new(robot: &Robot, line_mm_s: f64, window_s: f64) -> Self {
        let line = if line_mm_s > 0.0 { 1e-3 * line_mm_s } else { f64::INFINITY };
        Self { robot: robot.clone(), line, window_s, past: VecDeque::new(), used: 0.0 }
    }
}

impl Check for ReducedSpeed {
    fn trip(&self) -> Trip {
        Trip::ReducedSpeed
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        if self.line == f64::INFINITY {
            return None;
        }
        // Half a microsecond for the rounding of time stamps.
        let begin = sample.t - self.window_s + 5e-7;
        while self.past.get(1).is_some_and(|(t, _)| *t <= begin) {
            self.past.pop_front();
        }
        let now = flange(&self.robot, sample.q);
        let speed = self
            .past
            .front()
            .filter(|(t, _)| *t <= begin)
            .map_or(0.0, |(t, before)| distance(before, &now) / (sample.t - t));
        self.past.push_back((sample.t, now));
        self.used = self.used.max(speed / self.line);
        let (found, line) = (1e3 * speed, 1e3 * self.line);
        (speed > self.line).then(|| format!("the flange moves at {found:.0} mm/s, expected at most {line:.0} mm/s"))
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
