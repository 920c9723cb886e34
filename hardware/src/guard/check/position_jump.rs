//! Positions that move further between two samples than the joint can.

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where `|q_k − q_{k−1}| > jump + 1.5 q̇_max max(t_k − t_{k−1}, T)` with the sampling period T: an encoder that
/// slipped, joints in another order, or a message of another robot.
pub(super) struct PositionJump {
    bounds: Vec<JointBounds>,
    period_s: f64,
    before: Option<(f64, Vec<f64>)>,
    used: f64,
}

impl PositionJump {
    pub(super) fn new(bounds: &[JointBounds], period_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), period_s, before: None, used: 0.0 }
    }
}

impl Check for PositionJump {
    fn trip(&self) -> Trip {
        Trip::PositionJump
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let mut found = None;
        if let Some((t, before)) = &self.before {
            let dt = (sample.t - t).max(self.period_s);
            for (j, joint) in self.bounds.iter().enumerate() {
                // Without a speed limit there is no threshold: no jump would be too large for the time between two
                // samples.
                let line = joint.jump + 1.5 * joint.velocity * dt;
                let moved = (sample.q[j] - before[j]).abs();
                if line.is_finite() {
                    self.used = self.used.max(moved / line);
                }
                if moved > line && found.is_none() {
                    found = Some(format!(
                        "joint \"{}\": position moved {moved:.4} {unit} in {:.1} ms, expected at most {line:.4} {unit}",
                        joint.name,
                        1e3 * (sample.t - t),
                        unit = joint.unit,
                    ));
                }
            }
        }
        self.before = Some((sample.t, sample.q.to_vec()));
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
