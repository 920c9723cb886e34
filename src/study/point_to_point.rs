//! A move of all joints from one pose to another, at rest at both ends.
//!
//! ```text
//! q(t) = q_0 + (q_1 − q_0) S(t/T)      S(u) = 10u³ − 15u⁴ + 6u⁵      0 ≤ t ≤ T
//! max |q̇| = (15/8) |Δ|/T      max |q̈| = (10/√3) |Δ|/T²      max |q⃛| = 60 |Δ|/T³      Δ = q_1 − q_0, joint by joint
//! ```
//! The straight line between the two in joint space, of minimum jerk ([`QuinticStep`]): every joint stays between its two
//! places, so that a move between poses inside the position limits keeps them.
//!
//! Reference: T. Flash, N. Hogan, "The coordination of arm movements", J. Neuroscience 5(7), 1985.

use crate::model::Robot;
use crate::trajectory::{BSplineJoint, BSplineTrajectory, PeriodicTrajectory, QuinticStep, States};

/// Largest slope, curvature and third derivative of S.
const SLOPE: f64 = 1.875;
const CURVATURE: f64 = 5.773_502_691_896_258;
const JERK: f64 = 60.0;

/// Distance of the knots of a move there and back over the time in which its largest speed covers the way. The speed of the spline is a
/// quartic B-spline, whose peak is 115/192.
const KNOT: f64 = 0.55;

/// Equal values in a row that hold a spline at rest between moves.
const KNOTS_AT_REST: usize = 7;

/// Speed of a joint that states no limit, rad/s or m/s.
const UNLIMITED_SPEED: f64 = 1.0;

/// A quintic move between two poses.
#[derive(Clone, Debug, PartialEq)]
pub struct PointToPointMove {
    /// The pose that it begins at, n, rad or m.
    pub from: Vec<f64>,
    /// The pose that it ends at, n, rad or m.
    pub to: Vec<f64>,
    /// How long it takes, s.
    pub duration_s: f64,
}

impl PointToPointMove {
    /// The fastest move from one pose to another (n each, rad or m) that uses at most this share of every joint's limits of
    /// speed, acceleration and jerk. A joint without a limit of speed counts as limited to 1 rad/s or 1 m/s.
    pub(super) fn within_limits(robot: &Robot, from: Vec<f64>, to: Vec<f64>, share: f64) -> Self {
        let duration_of = |((joint, from), to): ((&crate::model::Joint, &f64), &f64)| {
            let (limits, way) = (&joint.limits, (to - from).abs());
            let speed = if limits.velocity.is_finite() { limits.velocity } else { UNLIMITED_SPEED };
            let by_speed = SLOPE * way / (share * speed);
            let by_acceleration = (CURVATURE * way / (share * limits.acceleration)).sqrt();
            let by_jerk = libm::cbrt(JERK * way / (share * limits.jerk));
            by_speed.max(by_acceleration).max(by_jerk)
        };
        let duration_s = robot.joints().iter().zip(&from).zip(&to).map(duration_of).fold(0.0, f64::max);
        Self { from, to, duration_s }
    }

    /// Returns this way in so many times the time.
    pub(super) fn slowed(&self, factor: f64) -> Self {
        Self { duration_s: factor * self.duration_s, ..self.clone() }
    }

    /// The move there and back as one period, at rest between, for an arm that repeats motions: a quintic spline along the same line.
    /// Its peak speed is at most 1.09 times that of the move and its peak acceleration 1.10 times, for which a move at 90 % of its
    /// limits leaves room. `whole` rounds the period up.
    pub(super) fn there_and_back(&self, robot: &Robot, whole: impl Fn(f64) -> f64) -> PeriodicTrajectory {
        let knot_s = KNOT * self.duration_s / SLOPE;
        let joint = |(j, joint): (usize, &crate::model::Joint)| BSplineJoint {
            name: joint.name.clone(),
            c: [self.from[j], self.to[j]].into_iter().flat_map(|place| [place; KNOTS_AT_REST]).collect(),
        };
        let joints = robot.joints().iter().enumerate().map(joint).collect();
        let period_s = whole(2.0 * KNOTS_AT_REST as f64 * knot_s);
        PeriodicTrajectory::BSpline(BSplineTrajectory { period_s, degree: 5, joints })
    }

    /// `count` states from the first pose to the last, at `t_k = k T / (count − 1)`.
    pub fn sample(&self, count: usize) -> States {
        let n = self.from.len();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut states = States::new(n);
        for k in 0..count {
            let step = QuinticStep::evaluate(k as f64 / count.saturating_sub(1).max(1) as f64);
            for j in 0..n {
                let way = self.to[j] - self.from[j];
                q[j] = self.from[j] + way * step.value;
                qd[j] = way * step.slope / self.duration_s;
                qdd[j] = way * step.curvature / (self.duration_s * self.duration_s);
            }
            states.push(&q, &qd, &qdd);
        }
        states
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::chains;
    use crate::model::Limits;

    #[test]
    fn analytic_the_tightest_limit_of_a_move_is_just_used() {
        // One joint moves 1 rad, the other 0.1 rad: speed, acceleration and jerk bind in turn.
        for (velocity, acceleration, jerk, duration) in [
            (0.5, f64::INFINITY, f64::INFINITY, 1.875 / 0.4),
            (f64::INFINITY, f64::INFINITY, f64::INFINITY, 1.875 / 0.8),
            (100.0, 2.0, f64::INFINITY, (10.0 / 3.0_f64.sqrt() / 1.6).sqrt()),
            (100.0, 1e9, 3.0, (60.0_f64 / 2.4).cbrt()),
        ] {
            let limits = Limits { velocity, acceleration, jerk, ..Limits::NONE };
            let robot = chains::planar_2r().with_joints(|joint| joint.limits = limits).unwrap();
            let made = PointToPointMove::within_limits(&robot, vec![0.0, 0.3], vec![1.0, 0.2], 0.8);
            assert!((made.duration_s - duration).abs() < 1e-12 * duration, "{} {duration}", made.duration_s);
            let states = made.sample(2001);
            let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let uses = [largest(&states.qd) / velocity.min(1e3), largest(&states.qdd) / acceleration];
            assert!(uses.iter().all(|used| *used < 0.8 + 1e-9 || velocity.is_infinite()), "{uses:?}");
        }
    }

    #[test]
    fn identity_a_move_rests_at_its_poses_and_is_the_integral_of_its_acceleration() {
        let robot = chains::crs_a460();
        let (from, to) = (vec![0.1, -0.4, 0.3, 0.9, -1.0, 2.0], vec![-0.5, 0.2, 0.3, -0.6, 0.7, -1.0]);
        let made = PointToPointMove::within_limits(&robot, from.clone(), to.clone(), 0.9);
        let (count, n) = (4001, 6);
        let states = made.sample(count);
        assert_eq!(states.q(0), &from[..]);
        let at_end = states.q(count - 1).iter().zip(&to).all(|(found, to)| (found - to).abs() < 1e-15);
        assert!(at_end);
        for k in [0, count - 1] {
            assert!(states.qd(k).iter().chain(states.qdd(k)).all(|value| value.abs() == 0.0));
        }
        // There and back: both poses at rest, 115/192/0.55 times as fast as the move, acceleration times 0.5455 S'²/(0.55² S'').
        let repeated = made.there_and_back(&robot, |period_s| period_s).sample(14_000);
        for (k, pose) in [(6000, &from), (13_000, &to)] {
            assert!(repeated.q(k).iter().zip(pose).all(|(found, pose)| (found - pose).abs() < 1e-12), "{k}");
            assert!(repeated.qd(k).iter().chain(repeated.qdd(k)).all(|value| value.abs() < 1e-9), "{k}");
        }
        let peak = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!((peak(&repeated.qd) / peak(&states.qd) - 115.0 / 192.0 / 0.55).abs() < 1e-5);
        assert!((peak(&repeated.qdd) / peak(&states.qdd) - 1.098).abs() < 0.001);
        let step = made.duration_s / (count - 1) as f64;
        for j in 0..n {
            let (mut speed, mut way) = (0.0, 0.0);
            for k in 1..count {
                speed += 0.5 * step * (states.qdd(k - 1)[j] + states.qdd(k)[j]);
                way += 0.5 * step * (states.qd(k - 1)[j] + states.qd(k)[j]);
                assert!((speed - states.qd(k)[j]).abs() < 1e-5);
            }
            assert!((way - (to[j] - from[j])).abs() < 1e-5);
        }
    }
}
