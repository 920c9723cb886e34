//! What the simulated drives do between set point and link is found: how late their currents are, and how stiff they are.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::calibration::{StiffnessVerdict, TransmissionStiffness, transmission_stiffness};
use armid::estimation::{EstimatorKind, Identification, Selection, Verdict, candidate_terms, predict, select};
use armid::experiment::{ActualArm, EffectKind, Effects, ExperimentPlan, Recorder, Recording, Servo};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{Processing, Samples, process};
use armid::study::{Truth, truth_text};
use armid::trajectory::{FourierJoint, FourierTrajectory};
use armid_sim::AnalyticPlant;
use nalgebra::DVector;

/// The planar arm, its guess and its truth.
fn planar() -> (Robot, StandardParameters, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let truth = Truth::from_toml(truth_text("planar-2r").unwrap(), &robot).unwrap().parameters;
    (robot, nominal, truth)
}

/// Five seconds of motion, five times.
fn plan(robot: &Robot) -> ExperimentPlan {
    let series = [([0.5, 0.4, -0.3], [0.3, -0.4, 0.2]), ([-0.7, 0.4, 0.3], [0.4, 0.5, -0.3])];
    let joints = robot.joints().iter().zip(series).map(|(joint, (a, b))| FourierJoint {
        name: joint.name.clone(),
        a: a.to_vec(),
        b: b.to_vec(),
        q0: 0.4,
    });
    let motion = FourierTrajectory { period_s: 5.0, joints: joints.collect() };
    ExperimentPlan { settle_s: 0.3, ramp_s: 1.0, periods: 5, ..ExperimentPlan::new(motion) }
}

/// What the arm's own sensors make of an experiment under effects, and where its links were.
fn recorded(effects: &Effects, seed: u64) -> (Recording, Vec<f64>) {
    let (robot, nominal, truth) = planar();
    let arm = ActualArm::new(effects, &robot, &truth);
    let plant = AnalyticPlant::new(arm.robot(), arm.parameters()).unwrap();
    let servo = Servo::new(&robot, &nominal, plant).unwrap().with_seed(Seed::new(seed), 0);
    let (mut servo, mut recorder, mut links) = (servo.with_effects(arm), Recorder::default(), Vec::new());
    let ending =
        servo.perform_observed(&plan(&robot), &mut recorder, &mut |state| links.extend_from_slice(state.q)).unwrap();
    assert!(ending.is_complete(), "{ending:?}");
    (recorder.into_recording().unwrap(), links)
}

fn selected(samples: &Samples) -> Selection {
    let (robot, _, _) = planar();
    let candidates = candidate_terms().into_iter().fold(Columns::RIGID, Columns::with);
    select(|columns| Identification::new(&robot, columns), samples, &[], candidates).unwrap()
}

fn verdict_of_lag(selection: &Selection) -> Verdict {
    selection.terms.iter().find(|term| term.term == "current-lag").unwrap().verdict
}

#[test]
fn simulated_lags_and_delays_of_the_currents_are_found_and_none_where_there_is_none() {
    let (robot, _, truth) = planar();
    let of = |kind, magnitude| Effects::none().with(kind, magnitude);
    // A lag of 3 ms, and a delay of four steps of 1 ms.
    for (effects, time) in [(of(EffectKind::CurrentLag, 3.0), 3e-3), (of(EffectKind::CurrentDelay, 4.0), 4e-3)] {
        let samples = process(&recorded(&effects, 3).0, &robot, &Processing::default()).unwrap();
        let selection = selected(&samples);
        assert_eq!(verdict_of_lag(&selection), Verdict::Supported, "{:?}", selection.terms);
        let found: Vec<_> = selection.beyond_motion.iter().filter(|one| one.term == "current-lag").collect();
        assert_eq!(found.len(), 2);
        for one in found {
            let [low, high] = one.ci95;
            assert!(low < time && time < high && high - low < 0.3 * time, "{one:?} {time} {}", selection.columns);
        }
        // The other parameters, by the torque that they make along the motion.
        let columns = Columns::parse(&selection.columns).unwrap();
        let identification = Identification::new(&robot, columns).unwrap();
        let estimate = identification.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap();
        let exact = identification.base().beta(&truth.vector(&robot, columns));
        let w =
            identification.base().select_columns(&JointTorqueRegressor::new(&robot, columns).stack(&samples.states));
        let error = |beta: DVector<f64>| (&w * (beta - &exact)).norm();
        let beside = selection.parameters_beside.iter().filter(|one| one.term == "current-lag").map(|one| one.value);
        let (with, without) = (error(DVector::from_iterator(exact.len(), beside)), error(estimate.beta()));
        assert!(with < 0.6 * without, "{with} {without} of {}", selection.columns);
    }
    for seed in 4..9 {
        let samples = process(&recorded(&Effects::none(), seed).0, &robot, &Processing::default()).unwrap();
        let selection = selected(&samples);
        assert_ne!(verdict_of_lag(&selection), Verdict::Supported, "{seed}: {:?}", selection.beyond_motion);
    }
}

/// The transmissions of the arm with these effects, link encoders of 2π/2¹⁹ rad.
fn transmissions(effects: &Effects, seed: u64) -> Vec<TransmissionStiffness> {
    let (robot, _, _) = planar();
    let (recording, links) = recorded(effects, seed);
    let step = std::f64::consts::TAU / f64::from(1 << 19);
    let of_links = Recording { q: links.iter().map(|q| (q / step).round() * step).collect(), ..recording.clone() };
    let processed = |recording: &Recording| process(recording, &robot, &Processing::default()).unwrap();
    let samples = processed(&recording).with_link_positions(&processed(&of_links));
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let identification = Identification::new(&robot, columns).unwrap();
    let estimate = identification.estimate(&samples, EstimatorKind::Wls.estimator()).unwrap();
    let modelled = predict(&estimate, &JointTorqueRegressor::new(&robot, columns), &samples.states).unwrap();
    transmission_stiffness(&robot, &samples, &modelled).unwrap()
}

#[test]
fn simulated_springs_of_drives_are_found_between_two_encoders_and_none_where_there_is_none() {
    let (robot, _, _) = planar();
    for seed in [1, 2] {
        let wind_up = 6e-3;
        let found = transmissions(&Effects::none().with(EffectKind::Elasticity, 1e3 * wind_up), seed);
        for (one, joint) in found.iter().zip(robot.joints()) {
            let truth = joint.limits.torque / wind_up;
            let stiffness = one.stiffness.unwrap_or_else(|| panic!("{one:?}"));
            assert!(stiffness.covers(truth), "{one:?} {truth}");
            assert!(stiffness.ci95[1] - stiffness.ci95[0] < 0.2 * truth, "{one:?}");
        }
        let rigid = transmissions(&Effects::none(), seed);
        assert!(rigid.iter().all(|one| one.verdict != StiffnessVerdict::Decided), "{rigid:?}");
    }
}
