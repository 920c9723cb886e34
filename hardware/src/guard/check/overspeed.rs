//! Joints that are faster than they may be.

use std::collections::VecDeque;

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where a joint moved faster than its limit over a window W, which takes counts and noise of the encoder out:
///
/// ```text
/// |q(t) − q(t − W)| / W > overspeed · q̇_max
/// ```
pub(super) struct Overspeed {
    bounds: Vec<JointBounds>,
    window_s: f64,
    past: VecDeque<(f64, Vec<f64>)>,
    used: f64,
}

impl Overspeed {
    pub(super) fn new(bounds: &[JointBounds], window_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), window_s, past: VecDeque::new(), used: 0.0 }
    }
}

impl Check for Overspeed {
    fn trip(&self) -> Trip {
        Trip::Overspeed
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        // Half a microsecond for the rounding of time stamps.
        let begin = sample.t - self.window_s + 5e-7;
        while self.past.get(1).is_some_and(|(t, _)| *t <= begin) {
            self.past.pop_front();
        }
        let mut found = None;
        if let Some((t, q)) = self.past.front().filter(|(t, _)| *t <= begin) {
            for (j, joint) in self.bounds.iter().enumerate() {
                let speed = (sample.q[j] - q[j]).abs() / (sample.t - t);
                if joint.overspeed.is_finite() {
                    self.used = self.used.max(speed / joint.overspeed);
                }
                if speed > joint.overspeed && found.is_none() {
                    found = Some(format!(
                        "joint \"{}\": {speed:.4} {unit}/s over {:.0} ms, expected at most {:.4} {unit}/s",
                        joint.name,
                        1e3 * (sample.t - t),
                        joint.overspeed,
                        unit = joint.unit,
                    ));
                }
            }
        }
        self.past.push_back((sample.t, sample.q.to_vec()));
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
