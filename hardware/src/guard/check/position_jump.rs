//! Positions that move further between two samples than the joint can.

use armid::experiment::{RawSample, ReceivedState};

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where `|q_k − q_{k−1}| > jump + 1.5 q̇_max max(t_k − t_{k−1}, T)` with the sampling period T: an encoder that
/// slipped, joints in another order, or a message of another robot. States as they arrive are judged so too, with no more
/// time between two of them than the local clock shows.
pub(super) struct PositionJump {
    bounds: Vec<JointBounds>,
    period_s: f64,
    before: Option<(f64, Vec<f64>)>,
    /// Stamp, soonest arrival and positions of the last state that arrived.
    arrived: Option<(f64, f64, Vec<f64>)>,
    used: f64,
}

impl PositionJump {
    pub(super) fn new(bounds: &[JointBounds], period_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), period_s, before: None, arrived: None, used: 0.0 }
    }

    /// Judges a way that took `span_s`.
    fn look(&mut self, before: &[f64], q: &[f64], span_s: f64) -> Option<String> {
        let mut found = None;
        for (j, joint) in self.bounds.iter().enumerate() {
            // Without a speed limit there is no threshold: no jump would be too large for the time between two
            // samples.
            let line = joint.jump + 1.5 * joint.velocity * span_s.max(self.period_s);
            let moved = (q[j] - before[j]).abs();
            if line.is_finite() {
                self.used = self.used.max(moved / line);
            }
            if moved > line && found.is_none() {
                found = Some(format!(
                    "joint \"{}\": position moved {moved:.4} {unit} in {:.1} ms, expected at most {line:.4} {unit}",
                    joint.name,
                    1e3 * span_s,
                    unit = joint.unit,
                ));
            }
        }
        found
    }
}

impl Check for PositionJump {
    fn trip(&self) -> Trip {
        Trip::PositionJump
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let before = self.before.replace((sample.t, sample.q.to_vec()));
        before.and_then(|(t, before)| self.look(&before, sample.q, sample.t - t))
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Option<String> {
        let soonest_s = state.arrival_s - state.lateness_s;
        let before = self.arrived.replace((state.stamp_s, soonest_s, state.q.to_vec()));
        before.and_then(|(stamp_s, arrival_s, before)| {
            self.look(&before, state.q, (state.stamp_s - stamp_s).min(state.arrival_s - arrival_s))
        })
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
