//! Motor currents that stay above the clamp.

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where the effort of a joint stays above its line for longer than the window. A single sample, which noise or a
/// converter may make, does not trip.
pub(super) struct CurrentClamp {
    bounds: Vec<JointBounds>,
    window_s: f64,
    above_since: Vec<Option<f64>>,
    longest: f64,
}

impl CurrentClamp {
    pub(super) fn new(bounds: &[JointBounds], window_s: f64) -> Self {
        Self { bounds: bounds.to_vec(), window_s, above_since: vec![None; bounds.len()], longest: 0.0 }
    }
}

impl Check for CurrentClamp {
    fn trip(&self) -> Trip {
        Trip::CurrentClamp
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let mut found = None;
        for (j, joint) in self.bounds.iter().enumerate() {
            let effort = sample.effort[j].abs();
            if effort <= joint.effort {
                self.above_since[j] = None;
                continue;
            }
            let above = sample.t - *self.above_since[j].get_or_insert(sample.t);
            self.longest = self.longest.max(above);
            if above > self.window_s && found.is_none() {
                found = Some(format!(
                    "joint \"{}\": effort is {effort:.3} {unit} for {:.0} ms, expected at most {:.3} {unit}",
                    joint.name,
                    1e3 * above,
                    joint.effort,
                    unit = joint.effort_unit,
                ));
            }
        }
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.longest) / self.window_s
    }
}
