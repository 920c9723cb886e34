//! Set-points that step further than the joint can move.

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where two set-points are further apart than 1.5 times the speed limit allows in a sampling period and the
/// largest age that a set-point may have.
pub(super) struct CommandStep {
    bounds: Vec<JointBounds>,
    span_s: f64,
    before: Option<Vec<f64>>,
    used: f64,
}

impl CommandStep {
    pub(super) fn new(bounds: &[JointBounds], span_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), span_s, before: None, used: 0.0 }
    }
}

impl Check for CommandStep {
    fn trip(&self) -> Trip {
        Trip::CommandStep
    }

    fn command(&mut self, set_point: &[f64], _: f64) -> Option<String> {
        let mut found = None;
        if let Some(before) = &self.before {
            for (j, joint) in self.bounds.iter().enumerate() {
                let line = 1.5 * joint.velocity * self.span_s;
                let step = (set_point[j] - before[j]).abs();
                if line.is_finite() {
                    self.used = self.used.max(step / line);
                }
                if step > line && found.is_none() {
                    let (name, unit) = (&joint.name, joint.unit);
                    found = Some(format!(
                        "joint \"{name}\": set-points are {step:.4} {unit} apart, expected at most {line:.4} {unit}"
                    ));
                }
            }
        }
        self.before = Some(set_point.to_vec());
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
