//! The distance between the arm and its command.

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips where `|q − r|` exceeds its limit.
pub(super) struct FollowingError {
    bounds: Vec<JointBounds>,
    used: f64,
}

impl FollowingError {
    pub(super) fn new(bounds: &[JointBounds]) -> Self {
        Self { bounds: bounds.to_vec(), used: 0.0 }
    }
}

impl Check for FollowingError {
    fn trip(&self) -> Trip {
        Trip::FollowingError
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let mut found = None;
        for (j, joint) in self.bounds.iter().enumerate() {
            let error = (sample.q[j] - sample.command[j]).abs();
            self.used = self.used.max(error / joint.following);
            if error > joint.following && found.is_none() {
                found = Some(format!(
                    "joint \"{}\": {error:.4} {unit} from its command, expected at most {:.4} {unit}",
                    joint.name,
                    joint.following,
                    unit = joint.unit,
                ));
            }
        }
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
