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
                let part = |gone: f64| (1.0 - gone / asked) / (1.0 - LEAST);
                let mut gone = (sample.q[j] - q[j]).abs();
                // Looked up only where it counts: where the joint has turned back, it has gone further in between.
                if part(gone) > self.used.min(1.0) {
                    let (low, high) = self
                        .past
                        .iter()
                        .fold((sample.q[j], sample.q[j]), |(low, high), (_, q, _)| (low.min(q[j]), high.max(q[j])));
                    gone = high - low;
                }
                self.used = self.used.max(part(gone));
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

#[cfg(test)]
mod tests {
    use armid::conformance::chains::planar_2r;
    use armid::experiment::Phase;

    use super::*;
    use crate::guard::GuardSettings;

    #[test]
    fn analytic_what_is_used_is_by_the_range_of_a_joint_that_turned_back() {
        let bounds = JointBounds::of_robot(&planar_2r(), &GuardSettings::default());
        // Between the first and the last sample the command goes 1 rad; the joint goes 0.7 rad, and 0.4 of it back.
        let mut check = UnexpectedStop::new(&bounds, 0.2);
        for (index, (command, q)) in [(0.0, 0.0), (0.5, 0.7), (1.0, 0.3)].into_iter().enumerate() {
            let t = 0.1 * index as f64;
            let (q, command) = ([q, 0.0], [command, 0.0]);
            let sample = RawSample {
                index,
                t,
                phase: Phase::Record,
                q: &q,
                effort: &[],
                voltage: &[],
                link_q: &[],
                command: &command,
            };
            assert_eq!(check.sample(&sample), None);
        }
        assert!((check.take_used() - (1.0 - 0.7) / 0.75).abs() < 1e-12);
    }
}
