//! A point of the arm that is faster than a person beside it allows.

use armid::experiment::{RawSample, ReceivedState};
use armid::model::Robot;

use super::{Check, Past};
use crate::guard::points::{Places, furthest, names, places};
use crate::guard::{ARRIVAL_WINDOW_S, OVERSPEED_WINDOW_S, Trip};

/// Trips where the flange, or a point that the robot file names, went further in a window W than the limit allows,
/// `|p(t) − p(t − W)| / W > v`, where a limit is set. Time is that of `Overspeed`: the robot's, and the local clock's.
pub(super) struct ReducedSpeed {
    robot: Robot,
    /// m/s; infinite where none is set.
    line: f64,
    past: Past<Places>,
    arrived: Past<Places>,
    names: Vec<String>,
    used: f64,
}

impl ReducedSpeed {
    /// `line_mm_s` of 0 sets none.
    pub(super) fn new(robot: &Robot, line_mm_s: f64) -> Self {
        let line = if line_mm_s > 0.0 { 1e-3 * line_mm_s } else { f64::INFINITY };
        let (names, robot) = (names(robot), robot.clone());
        let (past, arrived) = (Past::new(OVERSPEED_WINDOW_S), Past::new(ARRIVAL_WINDOW_S));
        Self { robot, line, past, arrived, names, used: 0.0 }
    }

    /// Judges the way from earlier places over `span_s`; none on the first look.
    fn look(&mut self, way: Option<((usize, f64), f64)>) -> Option<String> {
        let ((point, way), span_s) = way?;
        let speed = way / span_s;
        self.used = self.used.max(speed / self.line);
        let (found, line, name) = (1e3 * speed, 1e3 * self.line, &self.names[point]);
        (speed > self.line)
            .then(|| format!("point \"{name}\" moves at {found:.0} mm/s, expected at most {line:.0} mm/s"))
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
        let now = places(&self.robot, sample.q);
        let way = self.past.at(sample.t).map(|(t, before)| (furthest(before, &now), sample.t - t));
        self.past.push(sample.t, now);
        self.look(way)
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Option<String> {
        if self.line == f64::INFINITY {
            return None;
        }
        let now = places(&self.robot, state.q);
        let way = self.arrived.at(state.arrival_s).map(|(t, before)| (furthest(before, &now), state.arrival_s - t));
        self.arrived.push(state.arrival_s - state.lateness_s, now);
        self.look(way)
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
        let mut check = ReducedSpeed::new(robot, 250.0);
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
        let tip = NamedPoint { name: "tip".to_owned(), link: 2, position };
        let armed = robot.with_spec(|spec| spec.points = vec![tip]).unwrap();
        assert_eq!(said(&armed, 0.175), None);
        assert!(said(&armed, 0.19).unwrap().contains("\"tip\" moves at 266 mm/s"));
    }
}
