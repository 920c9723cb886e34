//! Whether an arm stands, judged from its joint states alone.

use std::collections::VecDeque;

use armid::model::{JointKind, Robot};

use super::JointRow;

/// How long every joint must have stood, s.
pub(crate) const WINDOW_S: f64 = 0.2;
/// Fewest states that show it: two that are alike may be the two ends of a swing.
const LEAST_STATES: usize = 3;
/// What a joint that stands moves within the window, as a speed: 0.5 deg/s, a servo that settles and noise.
const REST_RAD_S: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// Speed below which a prismatic joint rests, m/s.
const REST_M_S: f64 = 1e-3;
/// Part of that at which a joint may drift, by the line through the window: an arm that sinks does not stand. A servo without
/// an integral part creeps after braking: the simulated A460 by up to 0.37 deg/s for two seconds.
const DRIFT: f64 = 0.6;
/// A command that moved so much more than a joint that stands may shows that the joint no longer follows it.
const IGNORED: f64 = 5.0;

/// One state: its stamp, where the joints were and where the motion would have them.
struct ObservedState {
    stamp_ns: i64,
    q: Vec<f64>,
    planned: Vec<f64>,
}

/// Watches for rest: over [`WINDOW_S`] of states stamped after `since`,
///
/// ```text
/// max q_j − min q_j ≤ v_rest · WINDOW_S        for every joint, all finite
/// |slope of the line through q_j| ≤ DRIFT · v_rest
/// ```
pub(crate) struct RestWatch {
    since_ns: i64,
    /// Largest range of each joint, rad (m).
    range: Vec<f64>,
    window: VecDeque<ObservedState>,
}

impl RestWatch {
    /// Counts states stamped after `since_ns` of the robot's clock.
    pub(crate) fn new(robot: &Robot, since_ns: i64) -> Self {
        let speed = |kind: JointKind| if kind == JointKind::Revolute { REST_RAD_S } else { REST_M_S };
        let range = robot.joints().iter().map(|joint| WINDOW_S * speed(joint.kind)).collect();
        Self { since_ns, range, window: VecDeque::new() }
    }

    /// Discards what was observed: only states stamped after `since_ns` count from now on.
    pub(crate) fn restart(&mut self, since_ns: i64) {
        self.since_ns = since_ns;
        self.window.clear();
    }

    /// Takes a state, and where the motion under way would have the joints at its stamp.
    pub(crate) fn see(&mut self, row: &JointRow, planned: &[f64]) {
        if row.stamp_ns <= self.window.back().map_or(self.since_ns, |last| last.stamp_ns) {
            return;
        }
        self.window.push_back(ObservedState { stamp_ns: row.stamp_ns, q: row.q.clone(), planned: planned.to_vec() });
        while self.window.get(1).is_some_and(|second| row.stamp_ns - second.stamp_ns >= (WINDOW_S * 1e9) as i64) {
            self.window.pop_front();
        }
    }

    /// When the window that shows rest began, ns of the robot's clock; none while the arm moves or too little is known. A
    /// joint whose position is not a number is at rest where the drives are `off`: their brakes hold it.
    pub(crate) fn at_rest_since(&self, off: bool) -> Option<i64> {
        let (first, last) = (self.window.front()?, self.window.back()?);
        let whole = self.window.len() >= LEAST_STATES && last.stamp_ns - first.stamp_ns >= (WINDOW_S * 1e9) as i64;
        let stands = (0..self.range.len()).all(|j| {
            let spread = self.spread(j, |seen| &seen.q);
            (spread <= self.range[j] && self.drift(j).abs() <= DRIFT * self.range[j] / WINDOW_S)
                || (off && spread == f64::INFINITY)
        });
        (whole && stands).then_some(first.stamp_ns)
    }

    /// Whether the arm stands although the motion would have moved it: nothing follows that motion any more.
    pub(crate) fn ignores_its_motion(&self) -> bool {
        self.at_rest_since(false).is_some()
            && (0..self.range.len()).any(|j| self.spread(j, |seen| &seen.planned) > IGNORED * self.range[j])
    }

    /// Slope of the line of least squares through one joint's positions, rad/s (m/s).
    fn drift(&self, j: usize) -> f64 {
        let first = &self.window[0];
        let points = || {
            let point = |seen: &ObservedState| ((seen.stamp_ns - first.stamp_ns) as f64 * 1e-9, seen.q[j] - first.q[j]);
            self.window.iter().map(point)
        };
        let n = self.window.len() as f64;
        let (t, q) = points().fold((0.0, 0.0), |(t, q), point| (t + point.0 / n, q + point.1 / n));
        let (above, below) = points().fold((0.0, 0.0), |(above, below), point| {
            (above + (point.0 - t) * (point.1 - q), below + (point.0 - t) * (point.0 - t))
        });
        above / below
    }

    /// Range of one joint over the window; not finite where a value is not.
    fn spread(&self, j: usize, of: impl Fn(&ObservedState) -> &Vec<f64>) -> f64 {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for value in self.window.iter().map(|seen| of(seen)[j]) {
            if !value.is_finite() {
                return f64::INFINITY;
            }
            range = (range.0.min(value), range.1.max(value));
        }
        range.1 - range.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// States every 2 ms from `from` to `to` s, the first joint at `q(t)`, planned `plan(t)`.
    fn watch(watch: &mut RestWatch, (from, to): (f64, f64), q: impl Fn(f64) -> f64, plan: impl Fn(f64) -> f64) {
        for k in (from * 500.0) as i64..(to * 500.0) as i64 {
            let t = k as f64 / 500.0;
            let row = JointRow { stamp_ns: k * 2_000_000, q: vec![q(t), 0.3], ..JointRow::default() };
            watch.see(&row, &[plan(t), 0.3]);
        }
    }

    fn fresh(since_s: f64) -> RestWatch {
        RestWatch::new(&armid::conformance::chains::planar_2r(), (since_s * 1e9) as i64)
    }

    #[test]
    fn an_arm_that_stands_is_seen_after_a_window_and_not_before() {
        let mut seen = fresh(1.0);
        watch(&mut seen, (0.0, 1.19), |_| 0.1, |_| 0.1);
        assert_eq!(seen.at_rest_since(false), None, "states from before do not count");
        watch(&mut seen, (1.19, 1.25), |_| 0.1, |_| 0.1);
        assert!(seen.at_rest_since(false).unwrap() > 1_000_000_000);
        assert!(!seen.ignores_its_motion());
        seen.restart(1_250_000_000);
        assert_eq!(seen.at_rest_since(false), None);
    }

    #[test]
    fn analytic_the_line_is_three_tenths_of_a_degree_a_second_of_drift() {
        for (deg_s, stands) in [(0.0, true), (0.29, true), (-0.31, false), (0.4, false), (10.0, false)] {
            let mut seen = fresh(0.0);
            watch(&mut seen, (0.01, 0.5), |t| f64::to_radians(deg_s) * t, |_| 0.0);
            assert_eq!(seen.at_rest_since(false).is_some(), stands, "{deg_s}");
        }
        for (deg, stands) in [(0.045, true), (0.055, false)] {
            let mut seen = fresh(0.0);
            // A servo that hunts at 100 Hz.
            let hunts = |t: f64| f64::to_radians(deg) * (2.0 * std::f64::consts::PI * 100.0 * t + 0.5).sin();
            watch(&mut seen, (0.01, 0.5), hunts, |_| 0.0);
            assert_eq!(seen.at_rest_since(false).is_some(), stands, "{deg}");
        }
    }

    #[test]
    fn a_joint_that_is_no_number_never_stands() {
        let mut seen = fresh(0.0);
        watch(&mut seen, (0.01, 0.5), |_| f64::NAN, |_| 0.0);
        assert_eq!(seen.at_rest_since(false), None);
        assert!(seen.at_rest_since(true).is_some(), "the drives are off");
    }

    #[test]
    fn an_arm_that_stands_while_its_motion_goes_on_follows_nothing() {
        let mut seen = fresh(0.0);
        watch(&mut seen, (0.01, 0.5), |_| 0.2, |t| 0.5 * t);
        assert!(seen.ignores_its_motion());
    }
}
