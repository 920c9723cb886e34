//! Positions and set-points outside the soft limits.

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// How much further out a joint may go that already stands outside when the guard begins to look, rad (m): an approach
/// has to be able to bring it back.
const SLACK: f64 = 0.01;

/// Trips where a position or a set-point leaves the soft limits.
pub(super) struct SoftLimit {
    bounds: Vec<JointBounds>,
    /// What holds now: the soft limits, wider where the arm began outside of them and has not come back.
    range: Vec<(f64, f64)>,
    begun: bool,
    used: f64,
}

impl SoftLimit {
    pub(super) fn new(bounds: &[JointBounds]) -> Self {
        let range = bounds.iter().map(|joint| joint.soft).collect();
        Self { bounds: bounds.to_vec(), range, begun: false, used: 0.0 }
    }

    fn look(&mut self, what: &str, q: &[f64]) -> Option<String> {
        let mut found = None;
        for (j, joint) in self.bounds.iter().enumerate() {
            let (low, high) = self.range[j];
            let outside = q[j] < low || q[j] > high;
            self.used =
                self.used.max(if outside { joint.soft_use(q[j]).max(1.0) } else { joint.soft_use(q[j]).min(1.0) });
            if outside && found.is_none() {
                let (name, unit) = (&joint.name, joint.unit);
                found = Some(format!(
                    "joint \"{name}\": {what} is {:.4} {unit}, expected within the soft limits {:.4} to {:.4} {unit}",
                    q[j], joint.soft.0, joint.soft.1
                ));
            }
        }
        found
    }

    /// The range that holds from a position on: once inside, the soft limits themselves.
    fn tighten(&mut self, q: &[f64]) {
        for (j, joint) in self.bounds.iter().enumerate() {
            let (low, high) = joint.soft;
            let range = &mut self.range[j];
            if self.begun {
                range.0 = range.0.max(low.min(q[j] - SLACK));
                range.1 = range.1.min(high.max(q[j] + SLACK));
            } else {
                // Outside the hard limits there is no way back but by hand.
                *range = (low.min(q[j] - SLACK).max(joint.hard.0), high.max(q[j] + SLACK).min(joint.hard.1));
            }
        }
        self.begun = true;
    }
}

impl Check for SoftLimit {
    fn trip(&self) -> Trip {
        Trip::SoftLimit
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let found = if self.begun { self.look("position", sample.q) } else { None };
        self.tighten(sample.q);
        found.or_else(|| self.look("position", sample.q))
    }

    fn command(&mut self, set_point: &[f64], _: f64) -> Option<String> {
        self.look("set-point", set_point)
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
