//! A motion that was handed over, checked and joined: polynomials between its points.
//!
//! Between two points: degree five where both have accelerations, three where both have velocities, one otherwise, as
//! ros2_control's joint trajectory controller does it.

use super::JointLimits;
use crate::link::JointMap;
use crate::message::{FollowResult, JointTrajectory};

/// Why a motion is refused, with the code of `FollowJointTrajectory`.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfit {
    /// One of the codes of [`FollowResult`].
    pub code: i32,
    /// In words.
    pub reason: String,
}

#[derive(Clone, Debug, PartialEq)]
struct Knot {
    t: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

/// A motion through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// When it begins, ns of the robot's clock; 0 for at once.
    pub start_ns: i64,
    knots: Vec<Knot>,
}

/// Checks inside each interval beside its ends: a polynomial of degree five has few turns.
const INSIDE: usize = 4;
/// Slack of the limits, for the rounding of what was sent.
const SLACK: f64 = 1e-6;

impl Spline {
    /// Checks a motion for the joints of `map`, in any order it names them.
    ///
    /// # Errors
    /// [`Unfit`] with what was found and what was expected.
    pub fn new(trajectory: &JointTrajectory, map: &JointMap, limits: &[JointLimits]) -> Result<Self, Unfit> {
        let invalid = |reason: String| Unfit { code: FollowResult::INVALID_GOAL, reason };
        let places = map
            .places(&trajectory.joint_names)
            .map_err(|error| Unfit { code: FollowResult::INVALID_JOINTS, reason: error.to_string() })?;
        let n = limits.len();
        let mut knots: Vec<Knot> = Vec::with_capacity(trajectory.points.len());
        for (k, point) in trajectory.points.iter().enumerate() {
            let t = point.time_from_start.seconds();
            let least = knots.last().map_or(0.0, |knot| knot.t);
            if t < least || (k > 0 && t <= least) {
                return Err(invalid(format!("point {k} is at {t} s, expected a time after {least} s")));
            }
            let take = |what: &str, list: &[f64], needed: bool| -> Result<Vec<f64>, Unfit> {
                if list.is_empty() && !needed {
                    return Ok(Vec::new());
                }
                if list.len() != trajectory.joint_names.len() || list.iter().any(|x| !x.is_finite()) {
                    return Err(invalid(format!("point {k}: {what} {list:?}, expected {n} finite numbers")));
                }
                Ok(places.iter().map(|&place| list[place]).collect())
            };
            let q = take("positions", &point.positions, true)?;
            let qd = take("velocities", &point.velocities, false)?;
            let qdd = take("accelerations", &point.accelerations, false)?;
            knots.push(Knot { t, q, qd, qdd });
        }
        if knots.is_empty() {
            return Err(invalid("no points, expected at least one".to_owned()));
        }
        let spline = Self { start_ns: trajectory.header.stamp.ns(), knots };
        spline.check(limits)?;
        Ok(spline)
    }

    fn check(&self, limits: &[JointLimits]) -> Result<(), Unfit> {
        let (mut q, mut qd) = (vec![0.0; limits.len()], vec![0.0; limits.len()]);
        let mut look = |t: f64| {
            self.evaluate(t, &mut q, &mut qd);
            for (j, joint) in limits.iter().enumerate() {
                let (low, high) = joint.position;
                let broken = if q[j] < low - SLACK || q[j] > high + SLACK {
                    format!("position {:.4}, expected {low:.4} to {high:.4}", q[j])
                } else if qd[j].abs() > joint.velocity * (1.0 + SLACK) {
                    format!("speed {:.4}, expected at most {:.4}", qd[j].abs(), joint.velocity)
                } else {
                    continue;
                };
                let reason = format!("joint \"{}\" at {t:.3} s: {broken} (rad, m, s)", joint.name);
                return Err(Unfit { code: FollowResult::INVALID_GOAL, reason });
            }
            Ok(())
        };
        look(self.knots[0].t)?;
        for pair in self.knots.windows(2) {
            for k in 1..=INSIDE {
                look(pair[0].t + (pair[1].t - pair[0].t) * k as f64 / INSIDE as f64)?;
            }
        }
        Ok(())
    }

    /// Returns this motion with a way to its first point, from where the joints are at `t` s: positions, velocities; n each.
    ///
    /// # Errors
    /// [`Unfit`] where that way leaves a limit.
    pub fn entered(mut self, t: f64, q: &[f64], qd: &[f64], limits: &[JointLimits]) -> Result<Self, Unfit> {
        let rates = |list: &[f64], like: &[f64]| if like.is_empty() { Vec::new() } else { list.to_vec() };
        let first = &self.knots[0];
        let (qd, qdd) = (rates(qd, &first.qd), rates(&vec![0.0; q.len()], &first.qdd));
        self.knots.insert(0, Knot { t, q: q.to_vec(), qd, qdd });
        self.check(limits)?;
        Ok(self)
    }

    /// Where it begins: position at its first point.
    pub fn first(&self) -> (f64, &[f64]) {
        (self.knots[0].t, &self.knots[0].q)
    }

    /// How long it takes, s.
    pub fn duration_s(&self) -> f64 {
        self.knots[self.knots.len() - 1].t
    }

    /// Position and velocity at `t` s after its beginning; at rest before its first and after its last point.
    pub fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64]) {
        let after = self.knots.partition_point(|knot| knot.t <= t);
        if after == 0 || after == self.knots.len() {
            let knot = &self.knots[after.saturating_sub(1)];
            q.copy_from_slice(&knot.q);
            if after > 0 && knot.t == t && !knot.qd.is_empty() {
                qd.copy_from_slice(&knot.qd);
            } else {
                qd.fill(0.0);
            }
            return;
        }
        let (a, b) = (&self.knots[after - 1], &self.knots[after]);
        let (span, s) = (b.t - a.t, t - a.t);
        for j in 0..q.len() {
            let way = b.q[j] - a.q[j];
            let c = if a.qd.is_empty() || b.qd.is_empty() {
                [0.0, way / span, 0.0, 0.0, 0.0, 0.0]
            } else {
                let (v0, v1) = (a.qd[j] * span, b.qd[j] * span);
                if a.qdd.is_empty() || b.qdd.is_empty() {
                    let (two, three) = (3.0 * way - 2.0 * v0 - v1, -2.0 * way + v0 + v1);
                    [0.0, v0 / span, two / (span * span), three / (span * span * span), 0.0, 0.0]
                } else {
                    let (a0, a1) = (a.qdd[j] * span * span, b.qdd[j] * span * span);
                    let three = 0.5 * (20.0 * way - 8.0 * v1 - 12.0 * v0 - 3.0 * a0 + a1);
                    let four = 0.5 * (-30.0 * way + 14.0 * v1 + 16.0 * v0 + 3.0 * a0 - 2.0 * a1);
                    let five = 0.5 * (12.0 * way - 6.0 * (v1 + v0) - a0 + a1);
                    let s2 = span * span;
                    [0.0, v0 / span, 0.5 * a0 / s2, three / (s2 * span), four / (s2 * s2), five / (s2 * s2 * span)]
                }
            };
            q[j] = a.q[j] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
            qd[j] = c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::LinkSettings;
    use crate::message::{Time, TrajectoryPoint};

    fn limits() -> Vec<JointLimits> {
        ["a", "b"]
            .map(|name| JointLimits { name: name.into(), position: (-1.0, 1.0), velocity: 3.0, acceleration: 20.0 })
            .to_vec()
    }

    fn map() -> JointMap {
        JointMap::new(&["a".to_owned(), "b".to_owned()], &LinkSettings::default()).unwrap()
    }

    /// 0.5 sin 2t and its first two derivatives, on joint a; half of it on b, which is named first.
    fn trajectory(degree: usize, step: f64) -> JointTrajectory {
        let point = |k: u32| {
            let t = f64::from(k) * step;
            let both = |x: f64| vec![0.5 * x, x];
            TrajectoryPoint {
                positions: both(0.5 * (2.0 * t).sin()),
                velocities: if degree > 1 { both((2.0 * t).cos()) } else { Vec::new() },
                accelerations: if degree > 3 { both(-2.0 * (2.0 * t).sin()) } else { Vec::new() },
                effort: Vec::new(),
                time_from_start: Time::from_s(t).unwrap(),
            }
        };
        let joint_names = vec!["b".to_owned(), "a".to_owned()];
        JointTrajectory { joint_names, points: (0..=(4.0 / step) as u32).map(point).collect(), ..Default::default() }
    }

    #[test]
    fn analytic_error_between_points_falls_with_the_degree() {
        // Largest error of Hermite interpolation: h^(d+1) max|q^(d+1)| / (2^(d+1) (d+1)!), for degrees 1, 3, 5.
        let h = 0.1_f64;
        for (degree, bound) in [(1, h * h * 2.0 / 8.0), (3, h.powi(4) * 8.0 / 384.0), (5, h.powi(6) * 32.0 / 46080.0)] {
            let spline = Spline::new(&trajectory(degree, h), &map(), &limits()).unwrap();
            let (mut q, mut qd) = ([0.0; 2], [0.0; 2]);
            let mut worst: f64 = 0.0;
            for k in 0..4000 {
                let t = f64::from(k) * 1e-3;
                spline.evaluate(t, &mut q, &mut qd);
                worst = worst.max((q[0] - 0.5 * (2.0 * t).sin()).abs());
                assert!((q[1] - 0.5 * q[0]).abs() < 1e-15);
                // The velocity is the derivative of the position.
                let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
                if degree > 1 && t > 1e-3 {
                    spline.evaluate(t - 1e-6, &mut low, &mut [0.0; 2]);
                    spline.evaluate(t + 1e-6, &mut high, &mut [0.0; 2]);
                    assert!(((high[0] - low[0]) / 2e-6 - qd[0]).abs() < 1e-5, "{t}");
                }
            }
            // Times are whole nanoseconds: 1e-9 of a motion at 1 rad/s.
            assert!(worst <= 1.001 * bound + 1e-9 && worst > 0.5 * bound.min(1e-9), "{degree}: {worst} {bound}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_reason() {
        type Change = fn(&mut JointTrajectory);
        let changes: [(&str, i32, Change); 9] = [
            ("unknown", FollowResult::INVALID_JOINTS, |t| t.joint_names[0] = "z".into()),
            ("missing", FollowResult::INVALID_JOINTS, |t| t.joint_names.truncate(1)),
            ("twice", FollowResult::INVALID_JOINTS, |t| t.joint_names[0] = "a".into()),
            ("no points", FollowResult::INVALID_GOAL, |t| t.points.clear()),
            ("expected a time after", FollowResult::INVALID_GOAL, |t| t.points[3].time_from_start = Time::default()),
            ("finite", FollowResult::INVALID_GOAL, |t| t.points[2].positions[0] = f64::NAN),
            ("expected 2 finite", FollowResult::INVALID_GOAL, |t| t.points[2].velocities.truncate(1)),
            ("position", FollowResult::INVALID_GOAL, |t| {
                for point in &mut t.points {
                    for list in [&mut point.positions, &mut point.velocities, &mut point.accelerations] {
                        list.iter_mut().for_each(|x| *x *= 2.2);
                    }
                }
            }),
            ("speed", FollowResult::INVALID_GOAL, |t| t.points[2].velocities[1] = 9.0),
        ];
        for (word, code, change) in changes {
            let mut trajectory = trajectory(5, 0.1);
            change(&mut trajectory);
            let unfit = Spline::new(&trajectory, &map(), &limits()).unwrap_err();
            assert!(unfit.code == code && unfit.reason.contains(word), "{word}: {unfit:?}");
        }
    }

    #[test]
    fn it_rests_before_and_after() {
        let spline = Spline::new(&trajectory(5, 0.1), &map(), &limits()).unwrap();
        let (mut q, mut qd) = ([0.0; 2], [0.0; 2]);
        spline.evaluate(9.0, &mut q, &mut qd);
        assert!((q[0] - 0.5 * 8.0_f64.sin()).abs() < 1e-12 && qd == [0.0; 2]);
        spline.evaluate(-1.0, &mut q, &mut qd);
        assert_eq!((q, qd), ([0.0; 2], [0.0; 2]));
    }
}
