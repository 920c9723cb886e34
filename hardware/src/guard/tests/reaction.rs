//! Any stream of samples with a fault in it trips within the bound, and nothing but the safe action follows.

use armid::experiment::{Arm, Ending, SafeAction};
use proptest::prelude::*;

use super::stage::{Count, Deed, Fault, Stage, plan, robot, tripped};
use crate::guard::{GuardSettings, Guarded, Mode, Trip};

/// A fault, and the trips that may answer it: another check may be quicker than the one it is made for.
fn faults() -> impl Strategy<Value = (Fault, &'static [Trip])> {
    const STREAM: &[Trip] = &[Trip::CommandStep, Trip::SoftLimit, Trip::FollowingError];
    prop_oneof![
        Just((Fault::NotFinite, &[Trip::NotFinite][..])),
        (0.2..3.0_f64, any::<bool>())
            .prop_map(|(size, up)| (Fault::Jump(if up { size } else { -size }), &[Trip::PositionJump][..])),
        (0.5..2.0_f64).prop_map(|speed| (Fault::Outwards(speed), &[Trip::SoftLimit, Trip::Overspeed][..])),
        (0.2..1.5_f64).prop_map(|speed| (
            Fault::Drift(speed),
            &[Trip::FollowingError, Trip::SoftLimit, Trip::UnexpectedStop, Trip::Overspeed][..]
        )),
        (1.0..3.0_f64).prop_map(|part| (Fault::Current(part), &[Trip::CurrentClamp][..])),
        Just((Fault::Stop, &[Trip::UnexpectedStop, Trip::FollowingError][..])),
        Just((Fault::Silence, &[Trip::StaleState][..])),
        (0.021..0.5_f64).prop_map(|age| (Fault::Late(age), &[Trip::CommandAge][..])),
        (0.2..3.0_f64).prop_map(|size| (Fault::Step(size), STREAM)),
        Just((Fault::Robot, &[Trip::RobotStopped][..])),
    ]
}

fn is_of_stream(fault: Fault) -> bool {
    matches!(fault, Fault::Late(_) | Fault::Step(_))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn any_fault_ends_in_the_safe_action_within_its_bound(
        (fault, expected) in faults(),
        joint in 0..6_usize,
        // While it stands at the start pose, or in the periodic motion, whose speed is never small on all joints for a
        // whole window; before its last 0.7 s.
        at_s in prop_oneof![1 => -0.29..0.0_f64, 2 => 1.3..3.4_f64],
        rate_hz in prop_oneof![Just(500.0), Just(1000.0)],
        stream in any::<bool>(),
        jitter in 0.0..1.0_f64,
        lag_s in 0.0..0.01_f64,
    ) {
        let mode = if stream || is_of_stream(fault) { Mode::Stream } else { Mode::Trajectory };
        let settings = GuardSettings::default();
        // Who stands has nothing to stop.
        let at_s = if fault == Fault::Stop { at_s.max(1.3) } else { at_s };
        let mut stage = Stage::new(mode, &settings);
        (stage.fault, stage.joint, stage.at_s, stage.lead_s) = (fault, joint, at_s, 0.3);
        (stage.jitter, stage.lag_s, stage.noise) = (jitter, lag_s, 2e-5);
        let mut guarded = Guarded::new(stage, &robot(), &settings, mode);
        let mut sink = Count::default();
        let ending = guarded.perform(&plan(0.9, rate_hz), &mut sink).unwrap();
        let stage = guarded.arm();
        // A motion that drifts outwards slowly may be over before it is out; a drift may be noticed before its limit.
        let crossed_s = stage.crossed_s.unwrap_or(f64::INFINITY);
        if ending.is_complete() {
            prop_assert!(stage.crossed_s.is_none() && matches!(fault, Fault::Outwards(_)), "{fault:?} at {crossed_s} s");
            return Ok(());
        }
        let trip = Trip::parse(tripped(&ending).trip).unwrap();
        prop_assert!(expected.contains(&trip), "{fault:?} → {trip:?}");
        prop_assert!(trip.exists_in(mode));
        let safe: Vec<_> = stage.deeds.iter().filter(|(_, deed)| *deed != Deed::SetPoint).collect();
        prop_assert_eq!(safe.len(), 1);
        let (done_s, deed) = *safe[0];
        prop_assert_eq!(deed, Deed::Safe(trip.action(mode)));
        prop_assert_eq!(tripped(&ending).action, trip.action(mode));
        // Where another check was quicker, the bound is that of the check the fault is made for.
        let bound_ms = expected[0].bound_ms(&settings, rate_hz);
        let took_ms = 1e3 * (done_s - crossed_s);
        // A late set-point is noticed when it is about to be sent, which is as late as it is.
        let took_ms = if let Fault::Late(age) = fault { took_ms - 1e3 * age + settings.command_age_ms } else { took_ms };
        prop_assert!(took_ms <= bound_ms, "{trip:?} took {took_ms} ms, expected at most {bound_ms} ms");
        // Nothing is commanded after it, and nothing tripped before the fault.
        prop_assert!(stage.deeds.iter().all(|&(t, deed)| deed != Deed::SetPoint || t <= done_s));
        prop_assert!(done_s >= at_s - 0.002);
        prop_assert_eq!(sink.begun, 1);
        prop_assert!(sink.samples as f64 >= (at_s - 0.01) * rate_hz);
        // And no other experiment begins.
        let mut again = Count::default();
        let refused = guarded.perform(&plan(0.9, rate_hz), &mut again).unwrap_err().to_string();
        prop_assert!(refused.contains(trip.name()) && again.begun == 0, "{refused}");
    }
}

#[test]
fn a_sink_that_wants_to_stop_is_no_trip() {
    let settings = GuardSettings::default();
    let mut guarded = Guarded::new(Stage::new(Mode::Stream, &settings), &robot(), &settings, Mode::Stream);
    let mut sink = Count { stop_at: Some(700), ..Count::default() };
    let ending = guarded.perform(&plan(0.5, 1000.0), &mut sink).unwrap();
    assert!(matches!(ending, Ending::Stopped { .. }), "{ending:?}");
    assert_eq!(guarded.arm().deeds.last().unwrap().1, Deed::Rest);
    // The controlled stop was no fault: the next experiment may begin.
    assert!(guarded.perform(&plan(0.5, 1000.0), &mut Count::default()).unwrap().is_complete());
}

#[test]
fn a_trip_comes_before_a_stop() {
    let settings = GuardSettings::default();
    let mut stage = Stage::new(Mode::Stream, &settings);
    (stage.fault, stage.at_s) = (Fault::NotFinite, 0.699);
    let mut guarded = Guarded::new(stage, &robot(), &settings, Mode::Stream);
    let mut sink = Count { stop_at: Some(700), ..Count::default() };
    let ending = guarded.perform(&plan(0.5, 1000.0), &mut sink).unwrap();
    assert_eq!(tripped(&ending).action, SafeAction::Disable);
}
