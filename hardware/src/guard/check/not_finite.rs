//! Positions, efforts and set-points that are not finite numbers.

use armid::experiment::{RawSample, ReceivedState};

use super::Check;
use crate::guard::{JointBounds, Trip};

/// Trips on the first value that is NaN or infinite.
pub(super) struct NotFinite {
    names: Vec<String>,
    found: bool,
}

impl NotFinite {
    pub(super) fn new(bounds: &[JointBounds]) -> Self {
        Self { names: bounds.iter().map(|joint| joint.name.clone()).collect(), found: false }
    }

    fn look(&mut self, quantity: &str, values: &[f64]) -> Option<String> {
        let joint = values.iter().position(|value| !value.is_finite())?;
        self.found = true;
        let (name, value) = (&self.names[joint], values[joint]);
        Some(format!("joint \"{name}\": {quantity} is {value}, expected a finite number"))
    }
}

impl Check for NotFinite {
    fn trip(&self) -> Trip {
        Trip::NotFinite
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        self.look("position", sample.q).or_else(|| self.look("effort", sample.effort))
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Option<String> {
        self.look("position", state.q)
    }

    fn command(&mut self, set_point: &[f64], _: f64) -> Option<String> {
        self.look("set-point", set_point)
    }

    fn take_used(&mut self) -> f64 {
        f64::from(u8::from(std::mem::take(&mut self.found)))
    }
}
