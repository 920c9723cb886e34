//! An arm that is at rest while its command moves.

use std::collections::VecDeque;

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Part of the commanded distance that a joint must have gone.
const LEAST: f64 = 0.25;

/// Trips where over the window W the command of a joint moved, and the joint did not follow:
///
/// ```text
/// |r(t) − r(t − W)| ≥ max(following / 2, 2 jump)     and     max q − min q < ¼ |r(t) − r(t − W)|     over the window
/// ```
/// so that an arm which lags behind its command and turns back, or sticks for a moment where it turns, does not look as if
/// it stood. A slower command runs into the following error instead.
pub(super) struct UnexpectedStop {
    bounds: Vec<JointBounds>,
    window_s: f64,
    /// Time, positions, commands: the last window and one sample more.
    past: VecDeque<(f64, Vec<f64>, Vec<f64>)>,
    used: f64,
}

impl UnexpectedStop {
    pub(super) fn new(bounds: &[JointBounds], window_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), window_s, past: VecDeque::new(), used: 0.0 }
    }
}

impl Check for UnexpectedStop {
    fn trip(&self) -> Trip {
        Trip::UnexpectedStop
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        // Half a microsecond for the rounding of time stamps.
        let begin = sample.t - self.window_s + 5e-7;
        while self.past.get(1).is_some_and(|(t, ..)| *t <= begin) {
            self.past.pop_front();
        }
        let mut found = None;
        if let Some((t, q, command)) = self.past.front().filter(|(t, ..)| *t <= begin) {
            for (j, joint) in self.bounds.iter().enumerate() {
                let asked = (sample.command[j] - command[j]).abs();
                if asked < (joint.following / 2.0).max(2.0 * joint.jump) {
                    continue;
                }
                let mut gone = (sample.q[j] - q[j]).abs();
                if gone < LEAST * asked {
                    let (low, high) = self
                        .past
                        .iter()
                        .fold((sample.q[j], sample.q[j]), |(low, high), (_, q, _)| (low.min(q[j]), high.max(q[j])));
                    gone = high - low;
                }
                self.used = self.used.max(((1.0 - gone / asked) / (1.0 - LEAST)).max(0.0));
                if gone < LEAST * asked && found.is_none() {
                    found = Some(format!(
                        "joint \"{}\": moved {gone:.4} {unit} in {:.0} ms, expected most of the command's {asked:.4} {unit}",
                        joint.name,
                        1e3 * (sample.t - t),
                        unit = joint.unit,
                    ));
                }
            }
        }
        self.past.push_back((sample.t, sample.q.to_vec(), sample.command.to_vec()));
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
