//! Joints that are faster than they may be.

use armid::experiment::{RawSample, ReceivedState};

use super::{Check, Past};
use crate::guard::{ARRIVAL_WINDOW_S, JointBounds, OVERSPEED_WINDOW_S, Trip};

/// Trips where a joint moved faster than its limit over a window W, which takes counts and noise of the encoder out:
///
/// ```text
/// |q(t) − q(t − W)| / W > overspeed · q̇_max
/// ```
///
/// Time is the robot's, over 20 ms. States as they arrive are judged by the local clock as well, over 0.2 s: from when the
/// earlier one could have arrived at the soonest to when the later one has arrived, which is no less than the time between.
pub(super) struct Overspeed {
    bounds: Vec<JointBounds>,
    past: Past<Vec<f64>>,
    arrived: Past<Vec<f64>>,
    used: f64,
}

impl Overspeed {
    pub(super) fn new(bounds: &[JointBounds]) -> Self {
        let (past, arrived) = (Past::new(OVERSPEED_WINDOW_S), Past::new(ARRIVAL_WINDOW_S));
        Self { bounds: bounds.to_vec(), past, arrived, used: 0.0 }
    }

    /// Judges the way from an earlier position over `span_s`.
    fn look(
        bounds: &[JointBounds],
        used: &mut f64,
        (earlier, q): (&[f64], &[f64]),
        span_s: f64,
        clock: &str,
    ) -> Option<String> {
        let mut found = None;
        for (j, joint) in bounds.iter().enumerate() {
            let speed = (q[j] - earlier[j]).abs() / span_s;
            if joint.overspeed.is_finite() {
                *used = used.max(speed / joint.overspeed);
            }
            if speed > joint.overspeed && found.is_none() {
                found = Some(format!(
                    "joint \"{}\": {speed:.4} {unit}/s over {:.0} ms{clock}, expected at most {:.4} {unit}/s",
                    joint.name,
                    1e3 * span_s,
                    joint.overspeed,
                    unit = joint.unit,
                ));
            }
        }
        found
    }
}

impl Check for Overspeed {
    fn trip(&self) -> Trip {
        Trip::Overspeed
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let earlier = self.past.at(sample.t);
        let found = earlier
            .and_then(|(t, q)| Self::look(&self.bounds, &mut self.used, (q.as_slice(), sample.q), sample.t - t, ""));
        self.past.push(sample.t, sample.q.to_vec());
        found
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Option<String> {
        let earlier = self.arrived.at(state.arrival_s);
        let found = earlier.and_then(|(t, q)| {
            Self::look(
                &self.bounds,
                &mut self.used,
                (q.as_slice(), state.q),
                state.arrival_s - t,
                " of this machine's clock",
            )
        });
        self.arrived.push(state.arrival_s - state.lateness_s, state.q.to_vec());
        found
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guard::GuardSettings;

    /// Whether the first joint at `speed` of its limit, by a clock that runs at `rate`, is found too fast by arrival.
    fn found(speed: f64, rate: f64, late: impl Fn(usize) -> f64) -> bool {
        let robot = armid::conformance::chains::planar_2r();
        let mut bounds = JointBounds::of_robot(&robot, &GuardSettings::default());
        (bounds[0].velocity, bounds[0].overspeed) = (2.0, 2.2);
        let mut check = Overspeed::new(&bounds);
        let mut arrival_s = 0.0_f64;
        (0..500).any(|k| {
            let stamp_s = 2e-3 * k as f64;
            arrival_s = arrival_s.max(stamp_s / rate + late(k));
            let (lateness_s, q) = (arrival_s - stamp_s / rate, [2.0 * speed * stamp_s, 0.0]);
            check.received(&ReceivedState { stamp_s, arrival_s, lateness_s, q: &q }).is_some()
        })
    }

    #[test]
    fn analytic_speed_counts_by_arrivals_and_late_ones_are_no_speed() {
        assert!(!found(1.0, 1.0, |_| 0.0) && !found(1.0, 1.08, |_| 0.0));
        assert!(found(1.0, 1.12, |_| 0.0) && found(1.0, 2.0, |_| 0.0) && found(0.6, 2.0, |_| 0.0));
        // Bursts, and states that are up to 40 ms late.
        assert!(!found(1.0, 1.0, |k| 2e-3 * (24 - k % 25) as f64));
        assert!(!found(1.0, 1.0, |k| 0.04 * ((k * 7919) % 97) as f64 / 97.0));
    }
}
