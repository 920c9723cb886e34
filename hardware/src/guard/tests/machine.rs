//! Preflight, approach, and the experiment after it.

use armid::experiment::{Arm, ArmError, ExperimentPlan, SafeAction};

use super::stage::{Count, Deed, Fault, Stage, around, plan, robot, series, tripped};
use crate::guard::machine::Approached;
use crate::guard::preflight::of_survey;
use crate::guard::{Approach, Confirmation, GuardSettings, Guarded, JointBounds, Mode, Preflight, Survey, Trip};

fn confirmation() -> Confirmation {
    Confirmation::typed("crs-a460", "crs-a460\n").unwrap()
}

fn guarded(stage: Stage, settings: &GuardSettings) -> Guarded<Approached<Stage>> {
    let mode = stage.mode;
    Guarded::new(Approached::new(stage, &robot(), settings, confirmation()), &robot(), settings, mode)
}

#[test]
fn an_arm_that_stands_elsewhere_comes_to_the_start_pose_and_only_the_experiment_is_recorded() {
    let settings = GuardSettings::default();
    let mut stage = Stage::new(Mode::Stream, &settings);
    // Outside the soft limits, inside the hard ones: it may come back.
    stage.stands = vec![3.03, -0.5, 0.3, 0.2, -1.0, 0.0];
    stage.lead_s = 0.3;
    let mut guarded = guarded(stage, &settings);
    let mut sink = Count::default();
    let ending = guarded.perform(&plan(0.5, 1000.0), &mut sink).unwrap();
    assert!(ending.is_complete(), "{ending:?}");
    assert_eq!((sink.begun, sink.samples), (1, plan(0.5, 1000.0).layout().unwrap().samples()));
    let (passed, approach) = guarded.arm().before();
    assert_eq!(passed.len(), 6);
    // 15/8 · 2.94 rad at a tenth of 180°/s.
    assert!(approach.unwrap().duration_s > 15.0);
    // How it began is no matter of how close the experiment came to the soft limits.
    assert!(guarded.record().used["soft-limit"] < 0.9, "{:?}", guarded.record().used);
}

#[test]
fn a_trip_on_the_way_leaves_a_recording_without_samples() {
    let settings = GuardSettings::default();
    let mut stage = Stage::new(Mode::Trajectory, &settings);
    stage.stands = vec![1.0, 0.5, 0.3, 0.2, -1.0, 0.0];
    (stage.fault, stage.at_s) = (Fault::Jump(0.3), 1.0);
    let mut guarded = guarded(stage, &settings);
    let mut sink = Count::default();
    let ending = guarded.perform(&plan(0.5, 1000.0), &mut sink).unwrap();
    assert_eq!(tripped(&ending).trip, "position-jump");
    assert_eq!((sink.begun, sink.samples), (1, 0));
    assert_eq!(guarded.arm().machine().deeds.len(), 1);
    assert!(matches!(guarded.arm().machine().deeds[0].1, Deed::Safe(_)));
}

#[test]
fn a_fault_where_one_motion_ends_and_the_next_begins_trips_within_its_bound() {
    let settings = GuardSettings::default();
    let stands = vec![0.3, 0.2, 0.3, 0.2, -0.4, 0.0];
    let perform = |fault: Fault, at_s: f64| {
        let mut stage = Stage::new(Mode::Trajectory, &settings);
        (stage.fault, stage.joint, stage.at_s) = (fault, 2, at_s);
        (stage.stands, stage.lead_s) = (stands.clone(), 0.3);
        let mut guarded = guarded(stage, &settings);
        let ending = guarded.perform(&plan(0.5, 500.0), &mut Count::default()).unwrap();
        (guarded, ending)
    };
    let (clean, ending) = perform(Fault::None, 0.0);
    assert!(ending.is_complete(), "{ending:?}");
    let end_s = clean.arm().before().1.unwrap().duration_s;
    let faults = [
        (Fault::NotFinite, Trip::NotFinite),
        (Fault::Jump(0.3), Trip::PositionJump),
        (Fault::Current(1.5), Trip::CurrentClamp),
        (Fault::Silence, Trip::StaleState),
        (Fault::Robot, Trip::RobotStopped),
    ];
    for (fault, expected) in faults {
        // In the approach's last moments, as it ends, while the arm stands, and as the experiment begins.
        for since_s in [-0.015, -0.001, 0.0, 0.001, 0.015, 0.15, 0.285, 0.299, 0.3] {
            let (guarded, ending) = perform(fault, end_s + since_s);
            assert_eq!(Trip::parse(tripped(&ending).trip), Some(expected), "{fault:?} {since_s} s");
            let stage = guarded.arm().machine();
            let [(done_s, Deed::Safe(_))] = stage.deeds[..] else { panic!("{:?}", stage.deeds) };
            let took_ms = 1e3 * (done_s - stage.crossed_s.unwrap());
            let bound_ms = tripped(&ending).bound_ms;
            assert!(took_ms <= bound_ms, "{fault:?} {since_s} s: {took_ms} ms, expected at most {bound_ms} ms");
        }
    }
}

#[test]
fn an_arm_that_gives_up_at_the_start_pose_has_tripped() {
    let settings = GuardSettings::default();
    let mut stage = Stage::new(Mode::Trajectory, &settings);
    stage.stands = vec![0.3, 0.2, 0.3, 0.2, -0.4, 0.0];
    stage.gives_up = true;
    let mut guarded = guarded(stage, &settings);
    let mut sink = Count::default();
    let ending = guarded.perform(&plan(0.5, 500.0), &mut sink).unwrap();
    let trip = tripped(&ending);
    assert_eq!((trip.trip, trip.action), (Trip::RobotStopped.name(), SafeAction::Cancel));
    assert!(trip.reason.contains("estop"), "{trip}");
    // It moved on its way: the recording says so, with its plan, its ending and no sample.
    assert_eq!((sink.begun, sink.samples), (1, 0));
    let refused = guarded.perform(&plan(0.5, 500.0), &mut sink).unwrap_err().to_string();
    assert!(refused.contains("robot-stopped") && sink.begun == 1, "{refused}");
}

fn refused(fault: &Result<Vec<crate::guard::Passed>, ArmError>, check: Preflight) {
    match fault {
        Err(ArmError::Refused { check: found, .. }) => assert_eq!(*found, check.name()),
        other => panic!("{other:?}, expected {check:?}"),
    }
}

#[test]
fn an_arm_that_may_not_move_does_not() {
    let robot = robot();
    let bounds: Vec<JointBounds> = JointBounds::of_robot(&robot, &GuardSettings::default());
    let plan = plan(0.5, 1000.0);
    let good = Stage::new(Mode::Trajectory, &GuardSettings::default());
    let survey = crate::guard::Machine::survey(&mut good.clone()).unwrap();
    assert_eq!(of_survey(&bounds, &plan, &survey, &confirmation()).unwrap().len(), 6);
    let mut other = survey.clone();
    other.joints[2] = "Elbow".to_owned();
    refused(&of_survey(&bounds, &plan, &other, &confirmation()), Preflight::JointNames);
    refused(&of_survey(&bounds, &plan, &Survey { rate_hz: 400.0, ..survey.clone() }, &confirmation()), Preflight::Rate);
    for (outside, check) in [(2.0, Preflight::StartPose), (f64::NAN, Preflight::Finite)] {
        let mut q = survey.q.clone();
        q[1] = outside;
        refused(&of_survey(&bounds, &plan, &Survey { q, ..survey.clone() }, &confirmation()), check);
    }
    let effort = vec![0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0];
    refused(&of_survey(&bounds, &plan, &Survey { effort, ..survey.clone() }, &confirmation()), Preflight::Finite);
    let stopped = Survey { ready: Some(false), ..survey.clone() };
    refused(&of_survey(&bounds, &plan, &stopped, &confirmation()), Preflight::EmergencyStop);
    refused(&of_survey(&bounds, &plan, &Survey { homed: Some(false), ..survey }, &confirmation()), Preflight::Homed);
    assert_eq!(Confirmation::typed("crs-a460", "crs-a465"), None);
    assert_eq!(Confirmation::typed("crs-a460", ""), None);
}

#[test]
fn a_plan_that_leaves_the_soft_limits_is_refused_before_anything_is_announced() {
    let mut wide = series(0.5);
    let settings = GuardSettings::default();
    // The shoulder's hard limit is 90°, its soft limit 86°: the motion's outermost point goes to 88°.
    let states = wide.sample(3000);
    let outermost = (0..3000).map(|k| states.q(k)[1]).fold(f64::NEG_INFINITY, f64::max);
    wide.joints[1].q0 += 88_f64.to_radians() - outermost;
    let wide = around(wide, 1000.0);
    assert!(wide.check_limits(&robot()).is_ok());
    let refuse = |plan: &ExperimentPlan, settings: &GuardSettings, check: Preflight| {
        let mut guarded = Guarded::new(Stage::new(Mode::Stream, settings), &robot(), settings, Mode::Stream);
        let mut sink = Count::default();
        let fault = guarded.perform(plan, &mut sink).unwrap_err();
        assert!(matches!(&fault, ArmError::Refused { check: found, .. } if *found == check.name()), "{fault}");
        assert!(sink.begun == 0 && guarded.arm().deeds.is_empty());
    };
    refuse(&wide, &settings, Preflight::SoftLimits);
    refuse(&plan(0.5, 1000.0), &GuardSettings { stale_ms: 0.0, ..settings }, Preflight::Settings);
}

#[test]
fn analytic_an_approach_keeps_its_part_of_every_limit() {
    let (robot, settings) = (robot(), GuardSettings::default());
    let (from, to) = (vec![1.0, -0.5, 0.0, 0.0, 0.3, 2.0], vec![-1.2, 0.6, 0.01, 0.0, -0.3, -2.0]);
    let approach = Approach::new(&robot, &settings, &from, &to);
    let (mut q, mut qd, mut qdd, mut before) = (vec![0.0; 6], vec![0.0; 6], vec![0.0; 6], vec![0.0; 6]);
    let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
    let steps = 20_000;
    let dt = approach.duration_s / f64::from(steps);
    for k in 0..=steps {
        approach.evaluate(f64::from(k) * dt, &mut q, &mut qd, &mut qdd);
        for (j, joint) in robot.joints().iter().enumerate() {
            speed = speed.max(qd[j].abs() / joint.limits.velocity);
            if k > 0 {
                let difference = (qd[j] - before[j]) / dt;
                acceleration = acceleration.max(difference.abs() / joint.limits.acceleration);
                // A backward difference lags by half a step of less than 2 ms: half of it times the jerk.
                assert!((difference - qdd[j]).abs() < 1e-2, "{difference} {}", qdd[j]);
            }
            assert!(q[j] >= from[j].min(to[j]) - 1e-12 && q[j] <= from[j].max(to[j]) + 1e-12);
        }
        before.copy_from_slice(&qd);
    }
    assert!(q.iter().zip(&to).all(|(q, to)| (q - to).abs() < 1e-15), "{q:?}");
    // The speed of the joint with the longest way is what decides here: it reaches its part.
    assert!((speed - 0.1).abs() < 1e-6 && acceleration < 0.1 + 1e-6, "{speed} {acceleration}");
    let still = Approach::new(&robot, &settings, &from, &from);
    assert!(still.duration_s >= 0.5);
}
