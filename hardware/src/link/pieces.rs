//! A motion handed over in pieces, each of which ends at rest: no motion continues for long without supervision.
//!
//! ```text
//!   now            full_until         rest
//! ··●──●──●──●──●──●──●──●──●╲__________●        a piece: from two points before now to the end of its braking tail
//!          ··●──●──●──●──●──●──●──●──●╲__________●        the next one, sent well before `full_until`
//! ```
//! A piece keeps the time stamp of the whole motion, which is past by then, and the times of its points; it begins two
//! points before now. A controller that drops the old trajectory for the new one (`ros2_controllers` issue 896) then
//! interpolates between two of our points and nothing else, so that the joints stay on the certified path. On the tail
//! the time on the path slows down:
//!
//! ```text
//! σ̇(x) = 1 − 3x² + 2x³      x = (t − full_until)/span ∈ [0, 1]      σ̈ = 0 at both ends
//! q̈ = q''(σ) σ̇² + q'(σ) σ̈,   |σ̈| ≤ 3/(2 span)
//! ```
//! It stays on the path, with no more than its speeds; `span` is the shortest of a list by which every joint keeps its
//! acceleration limit.

use armid::model::Robot;
use armid_cdr::CdrError;

use super::Motion;
use crate::message::{Time, TrajectoryPoint};

/// Lengths of a braking tail to choose from, s.
const SPANS_S: [f64; 9] = [0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2, 1.6];
/// Places on a tail where accelerations are looked at.
const LOOKS: usize = 10;
/// Shortest part of a piece at full pace, s: what the next one has for its way.
const LEAST_FULL_S: f64 = 0.25;
/// Points before now with which a piece begins.
const BEFORE: usize = 2;

/// A part of a motion, with the times of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its points; times count from the beginning of the motion.
    pub points: Vec<TrajectoryPoint>,
    /// Time of the motion up to which it is the motion itself, s.
    pub full_until_s: f64,
    /// Time of the motion at which the arm rests if nothing follows, s.
    pub rest_s: f64,
    /// Whether it goes to the end of the motion.
    pub is_last: bool,
}

/// Number of intervals between the points of a motion.
fn intervals(motion: &dyn Motion, spacing_s: f64) -> usize {
    (motion.duration_s() / spacing_s).ceil().max(1.0) as usize
}

/// Points of a motion, no further apart than `spacing_s`, from its beginning to its end.
///
/// With position, velocity and acceleration in every point the robot controller joins two of them by a polynomial of
/// degree five, whose error is `h⁶ max|q⁗⁗| / 46080` (the sixth derivative): at 50 ms and the fifth harmonic of a
/// period of 10 s it is 2e-11 of the amplitude, of a period of 2 s 3e-7.
///
/// # Errors
/// [`CdrError::Time`] where the motion is longer than a message can say, 68 years.
pub fn points(motion: &dyn Motion, spacing_s: f64) -> Result<Vec<TrajectoryPoint>, CdrError> {
    let count = intervals(motion, spacing_s);
    (0..=count).map(|k| point(motion, motion.duration_s() * k as f64 / count as f64)).collect()
}

/// The point of a motion at `t`, in whole nanoseconds.
fn point(motion: &dyn Motion, t: f64) -> Result<TrajectoryPoint, CdrError> {
    let time_from_start = Time::from_s(t)?;
    let zero = vec![0.0; motion.dof()];
    let (mut positions, mut velocities, mut accelerations) = (zero.clone(), zero.clone(), zero);
    motion.evaluate(time_from_start.seconds(), &mut positions, &mut velocities, &mut accelerations);
    Ok(TrajectoryPoint { positions, velocities, accelerations, effort: Vec::new(), time_from_start })
}

/// The piece that is due at time `now_s` of the motion (below zero before it begins) and rests `horizon_s` later, or
/// later than that by what braking takes beyond it.
///
/// Before the motion begins the horizon counts from now as well: who has died by then is not waited for.
///
/// # Errors
/// As [`points`].
pub fn piece(
    motion: &dyn Motion,
    robot: &Robot,
    spacing_s: f64,
    now_s: f64,
    horizon_s: f64,
) -> Result<Piece, CdrError> {
    let (count, duration_s) = (intervals(motion, spacing_s), motion.duration_s());
    let time = |k: usize| duration_s * k as f64 / count as f64;
    let step_s = duration_s / count as f64;
    let first = ((now_s / step_s).floor().max(0.0) as usize).saturating_sub(BEFORE);
    // Every time of the motion is one that a message can carry, or the last is not.
    Time::from_s(duration_s)?;
    let sent = |last: usize| Time::from_s(time(last)).map_or(f64::INFINITY, Time::seconds);
    let span = |last: usize| braking_span(motion, robot, sent(last));
    // As much of the motion as rests within the horizon.
    let place = |t: f64| (t.max(0.0) as usize).min(count);
    let (least, most) =
        (place(((now_s + LEAST_FULL_S) / step_s).ceil()), place(((now_s + horizon_s) / step_s).floor()));
    let fits =
        |last: &usize| time(*last) + SPANS_S[0] <= now_s + horizon_s && time(*last) + span(*last) <= now_s + horizon_s;
    let last = (least..=most).rev().find(fits).unwrap_or(least);
    let span_s = span(last);
    let mut points: Vec<TrajectoryPoint> = (first..=last).map(|k| point(motion, time(k))).collect::<Result<_, _>>()?;
    let full_until_s = Time::from_s(time(last))?.seconds();
    // Where the tail would be as long as the motion that is left, the motion itself comes to rest as soon.
    if full_until_s + span_s >= duration_s {
        for k in last + 1..=count {
            points.push(point(motion, time(k))?);
        }
        return Ok(Piece { points, full_until_s: duration_s, rest_s: duration_s, is_last: true });
    }
    let steps = (span_s / step_s).ceil().max(1.0) as usize;
    for k in 1..=steps {
        points.push(tail_point(motion, full_until_s, span_s, span_s * k as f64 / steps as f64)?);
    }
    Ok(Piece { points, full_until_s, rest_s: full_until_s + span_s, is_last: false })
}

/// Path time, its rate and the rate of that, `u` s into a tail that begins at `from_s`.
fn slowed(from_s: f64, span_s: f64, u: f64) -> (f64, f64, f64) {
    let x = (u / span_s).clamp(0.0, 1.0);
    let travelled = x - x * x * x + 0.5 * x * x * x * x;
    (from_s + span_s * travelled, 1.0 - x * x * (3.0 - 2.0 * x), -6.0 * x * (1.0 - x) / span_s)
}

fn tail_point(motion: &dyn Motion, from_s: f64, span_s: f64, u: f64) -> Result<TrajectoryPoint, CdrError> {
    let time_from_start = Time::from_s(from_s + u)?;
    let (on_path, rate, acceleration) = slowed(from_s, span_s, (time_from_start.seconds() - from_s).min(span_s));
    let rests = u >= span_s;
    let mut point = TrajectoryPoint { time_from_start, ..Default::default() };
    let zero = vec![0.0; motion.dof()];
    (point.positions, point.velocities, point.accelerations) = (zero.clone(), zero.clone(), zero);
    motion.evaluate(on_path, &mut point.positions, &mut point.velocities, &mut point.accelerations);
    for j in 0..motion.dof() {
        let (qd, qdd) = (point.velocities[j], point.accelerations[j]);
        point.velocities[j] = if rests { 0.0 } else { qd * rate };
        point.accelerations[j] = if rests { 0.0 } else { qdd * rate * rate + qd * acceleration };
    }
    Ok(point)
}

/// The shortest tail from `from_s` by which every joint keeps its acceleration limit; the longest where none does.
fn braking_span(motion: &dyn Motion, robot: &Robot, from_s: f64) -> f64 {
    let fits = |span_s: &&f64| {
        (0..=LOOKS).all(|k| {
            let point = tail_point(motion, from_s, **span_s, **span_s * 0.999 * k as f64 / LOOKS as f64);
            let limits = robot.joints().iter().map(|joint| joint.limits.acceleration);
            // A point that no message can hold is refused where it is made.
            point.is_ok_and(|point| point.accelerations.iter().zip(limits).all(|(qdd, limit)| qdd.abs() <= limit))
        })
    };
    SPANS_S.iter().find(fits).copied().unwrap_or(SPANS_S[SPANS_S.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::computer::{JointLimits, Spline};
    use crate::link::{JointMap, LinkSettings};
    use crate::message::{Header, JointTrajectory};

    /// 0.4 sin(ωt) (1 − cos(…))-like start is of no matter here: a motion in full swing, and its derivatives.
    struct Swing {
        omega: f64,
        duration_s: f64,
    }

    impl Motion for Swing {
        fn dof(&self) -> usize {
            2
        }
        fn duration_s(&self) -> f64 {
            self.duration_s
        }
        fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
            let w = self.omega;
            for (j, size) in [0.4, -0.2].into_iter().enumerate() {
                q[j] = size * (w * t).sin();
                qd[j] = size * w * (w * t).cos();
                qdd[j] = -size * w * w * (w * t).sin();
            }
        }
    }

    fn spline(robot: &Robot, points: Vec<TrajectoryPoint>) -> Spline {
        let joint_names: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let map = JointMap::new(&joint_names, &LinkSettings::default()).unwrap();
        let trajectory = JointTrajectory { header: Header::default(), joint_names, points };
        Spline::new(&trajectory, &map, &JointLimits::of_robot(robot)).unwrap()
    }

    #[test]
    fn identity_the_points_of_every_piece_are_those_of_the_whole_motion() {
        let robot = armid::conformance::chains::planar_2r();
        let motion = Swing { omega: 3.0, duration_s: 4.03 };
        let whole = points(&motion, 0.05).unwrap();
        for k in -20..400 {
            let now_s = f64::from(k) * 0.01;
            let piece = piece(&motion, &robot, 0.05, now_s, 0.5).unwrap();
            let full = piece.points.iter().filter(|p| p.time_from_start.seconds() <= piece.full_until_s + 1e-12);
            for point in full {
                assert!(whole.contains(point), "{now_s}: {point:?}");
            }
            // It begins two points before now, where there are as many.
            let begin = piece.points[0].time_from_start.seconds();
            assert!(begin <= (now_s - 0.099).max(0.0) && begin >= now_s.max(0.0) - 0.151, "{now_s} {begin}");
            assert!(piece.full_until_s >= (now_s + LEAST_FULL_S).min(motion.duration_s) - 1e-9);
            // It rests within the horizon, or goes on for no longer than the next one needs to come.
            let within =
                piece.rest_s <= now_s + 0.5 + 1e-9 || piece.full_until_s <= (now_s + LEAST_FULL_S).max(0.0) + 0.051;
            assert!(piece.is_last || within, "{now_s} {}", piece.rest_s);
            if !piece.is_last {
                let end = piece.points.last().unwrap();
                assert!((end.time_from_start.seconds() - piece.rest_s).abs() < 1e-8);
                assert!(end.velocities.iter().chain(&end.accelerations).all(|x| *x == 0.0));
            }
        }
    }

    #[test]
    fn analytic_a_tail_stays_on_the_path_within_every_limit_and_as_short_as_it_can() {
        let robot = armid::conformance::chains::planar_2r();
        let limit = |j: usize| robot.joints()[j].limits;
        for omega in [0.3, 1.0, 2.0] {
            let motion = Swing { omega, duration_s: 20.0 };
            for k in 0..60 {
                let now_s = 0.5 + 0.1 * f64::from(k);
                let piece = piece(&motion, &robot, 0.05, now_s, 0.5).unwrap();
                assert!(piece.rest_s - now_s <= 0.5 + 0.051 || piece.full_until_s - now_s <= LEAST_FULL_S + 0.051);
                let follow = spline(&robot, piece.points.clone());
                let (mut q, mut qd, mut before) = ([0.0; 2], [0.0; 2], None::<[f64; 2]>);
                let dt = 1e-3;
                for step in 0..((piece.rest_s - piece.full_until_s) / dt) as usize {
                    follow.evaluate(piece.full_until_s + step as f64 * dt, &mut q, &mut qd);
                    // Both joints move on one path: the second is −½ of the first.
                    assert!((q[1] + 0.5 * q[0]).abs() < 1e-9, "{q:?}");
                    for j in 0..2 {
                        assert!(qd[j].abs() <= limit(j).velocity);
                        if let Some(before) = before {
                            let acceleration = (qd[j] - before[j]).abs() / dt;
                            // Between two looks and two points a little more than at them.
                            assert!(acceleration <= 1.1 * limit(j).acceleration, "{acceleration} at {now_s}");
                        }
                    }
                    before = Some(qd);
                }
            }
        }
    }

    #[test]
    fn analytic_between_points_the_path_is_kept_to_the_error_of_the_polynomial() {
        let robot = armid::conformance::chains::planar_2r();
        let (omega, h) = (3.0, 0.05);
        let motion = Swing { omega, duration_s: 6.0 };
        let bound = 0.4 * f64::powi(omega * h, 6) / 46080.0 + 2e-9;
        for k in 0..50 {
            let now_s = 0.1 * f64::from(k);
            let piece = piece(&motion, &robot, h, now_s, 0.5).unwrap();
            let follow = spline(&robot, piece.points.clone());
            let (mut q, mut exact) = ([0.0; 2], [0.0; 2]);
            for step in 0..((piece.full_until_s - now_s) * 1e3) as usize {
                let t = now_s + step as f64 * 1e-3;
                follow.evaluate(t, &mut q, &mut [0.0; 2]);
                motion.evaluate(t, &mut exact, &mut [0.0; 2], &mut [0.0; 2]);
                assert!((q[0] - exact[0]).abs() <= bound, "{t}: {} {}", q[0], exact[0]);
            }
        }
    }

    #[test]
    fn pieces_one_after_the_other_reach_the_end() {
        let robot = armid::conformance::chains::planar_2r();
        let motion = Swing { omega: 1.0, duration_s: 2.0 };
        let (mut now_s, mut count) = (-0.5, 0);
        loop {
            let piece = piece(&motion, &robot, 0.05, now_s, 0.5).unwrap();
            count += 1;
            if piece.is_last {
                break assert_eq!(piece.points.last(), points(&motion, 0.05).unwrap().last());
            }
            now_s = now_s.max(0.0) + 0.1;
        }
        assert!(count > 10, "{count}");
    }
}
