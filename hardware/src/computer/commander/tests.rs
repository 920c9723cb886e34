use proptest::prelude::*;

use super::*;
use crate::link::{JointMap, LinkSettings};
use crate::message::{JointTrajectory, Time, TrajectoryPoint};

const DT: f64 = 1e-3;

fn limits() -> Vec<JointLimits> {
    ["a", "b"]
        .map(|name| JointLimits { name: name.into(), position: (-1.0, 1.0), velocity: 2.0, acceleration: 10.0 })
        .to_vec()
}

fn commander() -> Commander {
    Commander::new(limits(), Watchdog::default(), DT, &[0.0, 0.1])
}

/// From (0, 0.1) to (0.5, −0.1) and back, 1 s each way, at rest at every point.
fn spline(start: f64) -> Spline {
    let point = |t: f64, positions: [f64; 2]| TrajectoryPoint {
        positions: positions.to_vec(),
        velocities: vec![0.0; 2],
        accelerations: vec![0.0; 2],
        effort: Vec::new(),
        time_from_start: Time::from_s(t).unwrap(),
    };
    let points = vec![point(0.0, [start, 0.1]), point(1.0, [start + 0.5, -0.1]), point(2.0, [start, 0.1])];
    let trajectory = JointTrajectory { joint_names: vec!["a".into(), "b".into()], points, ..Default::default() };
    let map = JointMap::new(&trajectory.joint_names, &LinkSettings::default()).unwrap();
    Spline::new(&trajectory, &map, &limits()).unwrap()
}

/// Steps from `from` to `to` s, looking at every command: position, speed and its change stay within limits.
fn run(commander: &mut Commander, from: f64, to: f64) -> Vec<[f64; 2]> {
    let mut seen = Vec::new();
    let mut last = commander.command().to_vec();
    for k in (from / DT).round() as usize..(to / DT).round() as usize {
        commander.step(k as f64 * DT);
        let q = commander.command();
        for j in 0..2 {
            assert!(q[j].abs() <= 1.0 && (q[j] - last[j]).abs() <= 2.0 * DT * (1.0 + 1e-9), "{q:?} after {last:?}");
        }
        last = q.to_vec();
        seen.push([q[0], q[1]]);
    }
    seen
}

#[test]
fn a_motion_is_followed_to_its_end_and_told() {
    let mut commander = commander();
    commander.follow(spline(0.0), 0.5, 0.0).unwrap();
    assert_eq!(commander.doing(), "follow");
    let seen = run(&mut commander, 0.0, 2.6);
    assert_eq!(seen[400], [0.0, 0.1]);
    assert!((seen[1500][0] - 0.5).abs() < 1e-9 && (seen[1500][1] + 0.1).abs() < 1e-9);
    assert_eq!((commander.outcome(), commander.doing()), (Some(Outcome::Succeeded), "hold"));
    assert_eq!(commander.began_s(), Some(0.5));
    assert_eq!(commander.outcome(), None);
}

#[test]
fn a_cancelled_motion_comes_to_rest_on_its_path() {
    for at in [0.2, 0.75, 1.3, 2.2] {
        let mut commander = commander();
        commander.follow(spline(0.0), 0.5, 0.0).unwrap();
        run(&mut commander, 0.0, at);
        assert!(commander.cancel(at));
        let seen = run(&mut commander, at, at + 1.0);
        // The path is the straight line from (0, 0.1) to (0.5, −0.1).
        for q in &seen {
            assert!((q[1] - (0.1 - 0.4 * q[0])).abs() < 1e-9, "{q:?}");
        }
        assert_eq!(commander.outcome(), Some(Outcome::Cancelled));
        assert_eq!(seen[seen.len() - 1], seen[seen.len() - 200], "at rest");
        // Stopping from 0.94 rad/s at half of 10 rad/s² takes 0.19 s and 0.09 rad.
        let way = (seen[seen.len() - 1][0] - seen[0][0]).abs();
        assert!(way < 0.1, "{way}");
    }
    assert!(!commander().cancel(0.0));
}

#[test]
fn motions_that_begin_elsewhere_or_are_past_are_refused() {
    let mut commander = commander();
    let refusal = |result: Result<(), String>| result.unwrap_err();
    assert!(refusal(commander.follow(spline(0.2), 0.5, 0.0)).contains("where the arm is"));
    assert!(refusal(commander.follow(spline(0.0), 0.5, 2.6)).contains("it ended 0.1"));
    // It would be far from where the arm stands by now.
    assert!(refusal(commander.follow(spline(0.0), 0.5, 1.2)).contains("where the arm is"));
    commander.follow(spline(0.03), 0.5, 0.0).unwrap();
    // A small distance fades out without a jump.
    let seen = run(&mut commander, 0.0, 1.51);
    assert_eq!(seen[500][0], 0.0);
    assert!((seen[1500][0] - 0.53).abs() < 1e-9);
    commander.switch_off("estop");
    assert_eq!(commander.outcome(), Some(Outcome::Aborted));
    assert_eq!(commander.off(), Some("estop"));
    assert!(refusal(commander.follow(spline(0.0), 9.0, 8.0)).contains("estop"));
    assert!(!commander.set_point(&[0.0, 0.1], 3.0));
}

/// The motion of [`spline`] with points every 50 ms, from the one at `from` s to the one at `to` s.
fn part(from: usize, to: usize) -> Spline {
    let whole = spline(0.0);
    let point = |k: usize| {
        let t = k as f64 * 0.05;
        let (mut q, mut qd, mut later) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        whole.evaluate(t, &mut q, &mut qd);
        whole.evaluate(t + 1e-6, &mut [0.0; 2], &mut later);
        let accelerations = if k.is_multiple_of(20) {
            vec![0.0; 2]
        } else {
            vec![(later[0] - qd[0]) / 1e-6, (later[1] - qd[1]) / 1e-6]
        };
        let (positions, velocities) = (q.to_vec(), qd.to_vec());
        TrajectoryPoint {
            positions,
            velocities,
            accelerations,
            effort: Vec::new(),
            time_from_start: Time::from_s(t).unwrap(),
        }
    };
    let points = (from..=to).map(point).collect();
    let trajectory = JointTrajectory { joint_names: vec!["a".into(), "b".into()], points, ..Default::default() };
    let map = JointMap::new(&trajectory.joint_names, &LinkSettings::default()).unwrap();
    Spline::new(&trajectory, &map, &limits()).unwrap()
}

#[test]
fn a_piece_that_begins_before_now_is_joined_in_its_midst_where_the_old_motion_is_forgotten() {
    for replacement in [Replacement::AtOnce, Replacement::Deferred] {
        let (mut pieces, mut whole) = (commander(), commander());
        pieces.set_replacement(replacement);
        pieces.follow(part(0, 40), 0.5, 0.0).unwrap();
        whole.follow(part(0, 40), 0.5, 0.0).unwrap();
        let mut from = 0.0;
        for now in [0.9, 1.21, 1.5, 1.83] {
            let (a, b) = (run(&mut pieces, from, now), run(&mut whole, from, now));
            assert!(a.iter().zip(&b).all(|(a, b)| (a[0] - b[0]).abs() < 1e-9), "{replacement:?} before {now}");
            let first = ((now - 0.5) / 0.05_f64).floor() as usize - 2;
            pieces.follow(part(first, 40), 0.5, now).unwrap();
            from = now;
        }
        let (a, b) = (run(&mut pieces, from, 3.0), run(&mut whole, from, 3.0));
        assert!(a.iter().zip(&b).all(|(a, b)| (a[0] - b[0]).abs() < 1e-9), "{replacement:?}");
        assert_eq!(pieces.outcome(), Some(Outcome::Succeeded));
    }
}

#[test]
fn other_controllers_treat_a_motion_under_way_otherwise() {
    let replaced = |replacement: Replacement, from: usize, start_s: f64| {
        let mut commander = commander();
        commander.set_replacement(replacement);
        commander.follow(part(0, 40), 0.5, 0.0).unwrap();
        run(&mut commander, 0.0, 1.0);
        let taken = commander.follow(part(from, 40), start_s, 1.0);
        (commander, taken)
    };
    let (_, taken) = replaced(Replacement::Refused, 8, 0.5);
    assert!(taken.unwrap_err().contains("under way"));
    let (mut both, taken) = replaced(Replacement::BothCancelled, 8, 0.5);
    assert!(taken.is_ok());
    run(&mut both, 1.0, 2.0);
    assert_eq!(both.outcome(), Some(Outcome::Cancelled));
    // Half a second of the motion is past; where the stamp is ignored, it begins anew.
    let (mut anew, taken) = replaced(Replacement::Spliced, 8, 0.5);
    assert!(taken.is_ok());
    run(&mut anew, 1.0, 2.9);
    assert_eq!(anew.doing(), "follow", "it ends half a second late");
    // One that begins later waits for its time.
    for replacement in [Replacement::Deferred, Replacement::Spliced] {
        let (mut later, taken) = replaced(replacement, 0, 5.0);
        assert!(taken.is_ok());
        run(&mut later, 1.0, 2.4);
        assert_eq!(later.outcome(), None);
    }
}

#[test]
fn a_single_point_is_gone_to_from_wherever_the_arm_is() {
    let mut commander = commander();
    commander.follow(part(0, 40), 0.5, 0.0).unwrap();
    let before = run(&mut commander, 0.0, 1.0);
    let here = before[before.len() - 1];
    let point = TrajectoryPoint {
        positions: here.to_vec(),
        velocities: vec![0.0; 2],
        accelerations: vec![0.0; 2],
        effort: Vec::new(),
        time_from_start: Time::from_s(0.2).unwrap(),
    };
    let trajectory =
        JointTrajectory { joint_names: vec!["a".into(), "b".into()], points: vec![point], ..Default::default() };
    let map = JointMap::new(&trajectory.joint_names, &LinkSettings::default()).unwrap();
    let hold = Spline::new(&trajectory, &map, &limits()).unwrap();
    commander.follow(hold.clone(), 1.0, 1.0).unwrap();
    let seen = run(&mut commander, 1.0, 1.5);
    assert!((seen[300][0] - here[0]).abs() < 1e-9 && seen[300] == seen[499], "{here:?} {:?}", seen[300]);
    // Out of date, it is refused.
    assert!(commander.follow(hold, 1.0, 1.5).unwrap_err().contains("ago"));
}

/// Streams 0.3 sin 2t on joint a at 500 Hz from `from` to `to`.
fn stream(commander: &mut Commander, from: f64, to: f64) {
    for k in (from / DT).round() as usize..(to / DT).round() as usize {
        let t = k as f64 * DT;
        if k.is_multiple_of(2) {
            assert!(commander.set_point(&[0.3 * (2.0 * t).sin(), 0.1], t));
        }
        commander.step(t);
    }
}

#[test]
fn analytic_streamed_set_points_are_followed_a_period_late() {
    let mut commander = commander();
    stream(&mut commander, 0.0, 1.0);
    // At the last step the goal of 0.998 s is half a line away: 0.6 rad/s for two periods at most.
    assert!((commander.command()[0] - 0.3 * 1.998_f64.sin()).abs() < 0.6 * 4e-3);
    assert_eq!(commander.doing(), "stream");
}

#[test]
fn a_stream_that_ends_in_motion_is_brought_to_rest_and_then_switched_off() {
    let mut commander = commander();
    stream(&mut commander, 0.0, 0.5);
    let seen = run(&mut commander, 0.5, 0.6 - 3e-3);
    // The last set-point came at 0.498 s: 20 ms later braking begins, at 10 rad/s² from 0.33 rad/s.
    assert_eq!(commander.doing(), "stream");
    assert_eq!(seen[60], seen[90], "at rest before 60 ms");
    run(&mut commander, 0.597, 0.605);
    assert_eq!((commander.doing(), commander.off()), ("off", Some("disabled: no set-point for 100 ms")));
    assert!(!commander.set_point(&seen[90], 0.61));
}

#[test]
fn a_stream_that_ends_at_rest_just_holds() {
    let mut commander = commander();
    stream(&mut commander, 0.0, 0.5);
    let last = [0.3 * 0.996_f64.sin(), 0.1];
    for k in 500..540 {
        let t = f64::from(k) * DT;
        commander.set_point(&last, t);
        commander.step(t);
    }
    run(&mut commander, 0.54, 1.0);
    assert_eq!(commander.doing(), "hold");
    assert!((commander.command()[0] - last[0]).abs() < 1e-12);
}

#[test]
fn set_points_outside_the_limits_are_not_taken() {
    let mut commander = commander();
    for goal in [vec![1.1, 0.1], vec![f64::NAN, 0.1], vec![0.0], vec![0.5, 0.1]] {
        assert!(!commander.set_point(&goal, 0.0), "{goal:?}");
    }
    assert!(commander.set_point(&[0.01, 0.1], 0.0));
}

proptest! {
    /// Any set-points, at any times: no command leaves the limits of position and speed.
    #[test]
    fn nothing_streamed_leaves_the_limits(goals in proptest::collection::vec((-1.3..1.3_f64, -1.3..1.3_f64, 1..40_usize), 1..40)) {
        let mut commander = commander();
        let mut t = 0.0;
        for (a, b, pause) in goals {
            commander.set_point(&[a, b], t);
            let end = t + pause as f64 * DT;
            run(&mut commander, t, end);
            t = (end / DT).round() * DT;
        }
    }
}
