//! Motor currents that stay above the clamp, or come back above it again and again.

use std::collections::VecDeque;

use armid::experiment::RawSample;

use super::Check;
use crate::guard::{JointBounds, Trip};

/// In how many windows of time one window above the threshold is too much: an eighth. A sine wave at full current,
/// which is above 0.95 of it for 20.2 % of the time, counts.
const WINDOWS: f64 = 8.0;

/// Trips where the effort of a joint was above its limit for longer than the window, in all, within the last
/// [`WINDOWS`] windows:
///
/// ```text
/// ∫ [|τ_j| > limit_j] dt > W      over the last 8 W
/// ```
/// A single sample, which noise or a converter may make, does not trip; an oscillation does.
pub(super) struct CurrentClamp {
    bounds: Vec<JointBounds>,
    window_s: f64,
    before_s: Option<f64>,
    /// Spans above the limit: when each ended, and how long it was.
    above: Vec<VecDeque<(f64, f64)>>,
    longest: f64,
}

impl CurrentClamp {
    pub(super) fn new(bounds: &[JointBounds], window_s: f64) -> Self {
        let above = vec![VecDeque::new(); bounds.len()];
        Self { bounds: bounds.to_vec(), window_s, before_s: None, above, longest: 0.0 }
    }
}

impl Check for CurrentClamp {
    fn trip(&self) -> Trip {
        Trip::CurrentClamp
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        let mut found = None;
        let step = self.before_s.map_or(0.0, |before| (sample.t - before).max(0.0));
        self.before_s = Some(sample.t);
        for (j, joint) in self.bounds.iter().enumerate() {
            let (effort, above) = (sample.effort[j].abs(), &mut self.above[j]);
            while above.front().is_some_and(|(t, _)| *t < sample.t - WINDOWS * self.window_s) {
                above.pop_front();
            }
            if effort <= joint.effort {
                continue;
            }
            // Nothing is known between two samples: the one that is above stands for the time before it.
            above.push_back((sample.t, step));
            let total: f64 = above.iter().map(|(_, span)| span).sum();
            self.longest = self.longest.max(total);
            if total > self.window_s && found.is_none() {
                found = Some(format!(
                    "joint \"{}\": effort is {effort:.3} {unit}, above {:.3} {unit} for {:.0} of the last {:.0} ms, expected at \
                     most {:.0} ms",
                    joint.name,
                    joint.effort,
                    1e3 * total,
                    1e3 * WINDOWS * self.window_s,
                    1e3 * self.window_s,
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

#[cfg(test)]
mod tests {
    use armid::experiment::Phase;
    use armid::model::Drive;

    use super::*;
    use crate::guard::GuardSettings;

    /// When a current trips that is `of(t)` of the first joint's limit, at 500 Hz.
    fn trips_s(of: impl Fn(f64) -> f64) -> Option<f64> {
        let robot = armid::conformance::chains::planar_2r();
        // Its drives have no limit of their own, and without a limit there is no threshold.
        let drive = Drive { current_limit: 5.0, ..Drive::ideal() };
        let robot = robot.with_drives(vec![drive.clone(), drive]);
        let bounds = JointBounds::of_robot(&robot, &GuardSettings::default());
        let mut check = CurrentClamp::new(&bounds, 0.02);
        (0..1000).map(|k| f64::from(k) * 2e-3).find(|t| {
            let effort = [of(*t) * bounds[0].effort / 0.95, 0.0];
            let (q, phase) = ([0.0; 2], Phase::Settle);
            let sample =
                RawSample { index: 0, t: *t, phase, q: &q, effort: &effort, voltage: &[], link_q: &[], command: &q };
            check.sample(&sample).is_some()
        })
    }

    #[test]
    fn a_lasting_current_trips_after_the_window_and_an_oscillation_after_a_few() {
        assert!((trips_s(|_| 1.0).unwrap() - 0.022).abs() < 1e-9);
        assert!(trips_s(|t| (std::f64::consts::TAU * 10.0 * t).sin()).unwrap() < 0.15);
        assert!(trips_s(|t| if (t / 2e-3).round() as i64 % 2 == 0 { 1.0 } else { 0.0 }).unwrap() < 0.05);
    }

    #[test]
    fn peaks_that_a_motion_has_do_not_trip() {
        assert_eq!(trips_s(|t| (std::f64::consts::TAU * t).sin() * 0.94), None);
        // Four samples above in every 200 ms.
        assert_eq!(trips_s(|t| if t % 0.2 < 0.008 { 1.0 } else { 0.2 }), None);
    }
}
