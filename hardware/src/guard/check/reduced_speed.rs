//! A point of the arm that is faster than a person beside it allows.

use std::collections::VecDeque;

use armid::experiment::RawSample;
use armid::model::Robot;

use super::Check;
use crate::guard::Trip;
use crate::guard::points::{Places, furthest, names, places};

/// Trips where the flange, or a point that the robot file names, went further in a window W than the limit allows,
/// `|p(t) − p(t − W)| / W > v`, where a limit is set.
pub(super) struct ReducedSpeed {
    robot: Robot,
    /// m/s; infinite where none is set.
    line: f64,
    window_s: f64,
    past: VecDeque<(f64, Places)>,
    names: Vec<String>,
    used: f64,
}

impl ReducedSpeed {
    /// `line_mm_s` of 0 sets none.
    pub(super) fn new(robot: &Robot, line_mm_s: f64, window_s: f64) -> Self {
        let line = if line_mm_s > 0.0 { 1e-3 * line_mm_s } else { f64::INFINITY };
        let (names, robot) = (names(robot), robot.clone());
        Self { robot, line, window_s, past: VecDeque::new(), names, used: 0.0 }
    }
}

impl Check for ReducedSpeed {
    fn trip(&self) -> Trip {
        Trip::ReducedSpeed
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Option<String> {
        if self.line == f64::INFINITY {
            return None;
        }
        // Half a microsecond for the rounding of time stamps.
        let begin = sample.t - self.window_s + 5e-7;
        while self.past.get(1).is_some_and(|(t, _)| *t <= begin) {
            self.past.pop_front();
        }
        let now = places(&self.robot, sample.q);
        let earlier = self.past.front().filter(|(t, _)| *t <= begin);
        let (point, speed) = earlier.map_or((0, 0.0), |(t, before)| {
            let (point, way) = furthest(before, &now);
            (point, way / (sample.t - t))
        });
        self.past.push_back((sample.t, now));
        self.used = self.used.max(speed / self.line);
        let (found, line, name) = (1e3 * speed, 1e3 * self.line, &self.names[point]);
        (speed > self.line)
            .then(|| format!("point \"{name}\" moves at {found:.0} mm/s, expected at most {line:.0} mm/s"))
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}

#[cfg(test)]
mod tests {
    use armid::experiment::Phase;
    use armid::model::NamedPoint;

    use super::*;

    /// What is said of an arm whose first joint turns at `speed` rad/s, its second not at all.
    fn said(robot: &Robot, speed: f64) -> Option<String> {
        let mut check = ReducedSpeed::new(robot, 250.0, 0.02);
        (0..200).find_map(|k| {
            let t = f64::from(k) * 2e-3;
            let (q, phase) = ([speed * t, 0.0], Phase::Settle);
            check.sample(&RawSample {
                index: 0,
                t,
                phase,
                q: &q,
                effort: &[0.0; 2],
                voltage: &[],
                link_q: &[],
                command: &q,
            })
        })
    }

    #[test]
    fn analytic_a_named_point_trips_where_the_flange_does_not() {
        // The flange is 0.7 m from the axis: 250 mm/s are 0.357 rad/s. A tool as long as the arm halves that.
        let robot = armid::conformance::chains::planar_2r();
        assert_eq!(said(&robot, 0.35), None);
        assert!(said(&robot, 0.36).unwrap().contains("\"flange\" moves at 252 mm/s"));
        let position = robot.poses(&[0.0; 2])[1].translation;
        let armed = robot.with_points(vec![NamedPoint { name: "tip".to_owned(), link: 2, position }]);
        assert_eq!(said(&armed, 0.175), None);
        assert!(said(&armed, 0.19).unwrap().contains("\"tip\" moves at 266 mm/s"));
    }
}
