//! Estimators that simulate, on recordings of the simulated arm under its servo.
#![allow(clippy::unwrap_used, reason = "a test panics")]

mod arm;
mod commanded;
mod shooting;

use armid::base::{Method, reduce};
use armid::estimation::{
    ClosedLoopError, ClosedLoopReference, Estimate, EstimationError, EstimationProblem, EstimatorKind, Finding,
    Observation, Termination, closed_loop_of, complete,
};
use armid::experiment::{ExperimentPlan, Phase, Recording, Sensing};
use armid::model::format::parse_robot;
use armid::model::{ParameterId, Robot, StandardParameters, bundled};
use armid::observer::Unobserved;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid_sim::closed_loop;

use arm::{Arm, COLUMNS, gentle, short, slow};

#[test]
fn identity_a_start_beside_the_truth_ends_where_the_weighted_fit_does() {
    // One minimum near both: where a search begins is of no matter, and how many steps it takes is.
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&slow(&arm.robot), Sensing::default(), 0);
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let beside = arm.truth.vector(&arm.robot, COLUMNS) * 1.15;
    let start = StandardParameters::from_vector(&arm.robot, COLUMNS, beside.as_slice());
    for kind in [EstimatorKind::Didim, EstimatorKind::Clie] {
        let [from_fit, from_start] =
            [None, Some(&start)].map(|start| arm.estimate_from(start, kind, &recording, &samples));
        let steps = |estimate: &Estimate| match estimate.termination {
            Termination::Converged { iterations, .. } => iterations,
            other => panic!("{}: {other:?}", kind.name()),
        };
        assert!(steps(&from_start) > steps(&from_fit), "{}", kind.name());
        let apart = (from_start.beta() - from_fit.beta()).norm() / arm.beta().norm();
        assert!(apart < 1e-6, "{}: {apart:e}", kind.name());
    }
}

#[test]
fn identity_the_loop_moves_as_the_recorded_arm_does() {
    for name in ["planar-2r", "crs-a460"] {
        let arm = Arm::new(name);
        let recording = arm.record(&short(&arm.robot), Sensing::ideal(), 0);
        let motion = arm.closed_loop(&recording).motion(&arm.truth, &Unobserved).unwrap();
        // Sensors that read what is there, averaged over the recorded periods.
        let (n, first) = (recording.dof, recording.samples(Phase::Record).start);
        for k in 0..recording.period_samples {
            for i in 0..n {
                let mean = |table: &[f64]| {
                    (0..3).map(|p| table[(first + p * recording.period_samples + k) * n + i]).sum::<f64>() / 3.0
                };
                assert!((motion.states.q(k)[i] - mean(&recording.q)).abs() < 1e-12, "{name} {k} {i}");
            }
        }
        // Torque, position, velocity and acceleration are those of one arm, where the motion repeats.
        let long = ExperimentPlan { discarded_periods: 8, ..short(&arm.robot) };
        let known = closed_loop(&arm.robot, &arm.nominal, ClosedLoopReference::Plans(&[long])).unwrap();
        let motion = known.motion(&arm.truth, &Unobserved).unwrap();
        let tau = arm.regressor.stack(&motion.states) * arm.truth.vector(&arm.robot, COLUMNS);
        let size = tau.amax();
        for (a, b) in tau.iter().zip(&motion.tau) {
            assert!((a - b).abs() < 1e-10 * size, "{name}: {a} {b}");
        }
    }
}

#[test]
fn analytic_slopes_are_central_differences_of_the_simulation() {
    // The TX40's wrist is coupled, its servo runs at 5 kHz.
    for (name, rate_hz) in [("planar-2r", 500.0), ("crs-a460", 500.0), ("staubli-tx40", 1000.0)] {
        let arm = Arm::new(name);
        let plan = ExperimentPlan { rate_hz, discarded_periods: 0, ..short(&arm.robot).with_periods(1) };
        let known = closed_loop(&arm.robot, &arm.nominal, ClosedLoopReference::Plans(&[plan])).unwrap();
        let by: Vec<ParameterId> = arm.base.kept.iter().map(|&j| arm.base.parameters[j]).collect();
        let block = 10;
        let (motion, slopes) = known.slopes(&arm.truth, &by, block, &Unobserved).unwrap();
        assert_eq!(motion, known.motion(&arm.truth, &Unobserved).unwrap(), "{name}: the same bits");
        let n = arm.robot.dof();
        let means = |table: &[f64]| -> Vec<f64> {
            let blocks = table.len() / n / block;
            (0..blocks * n)
                .map(|row| {
                    let (m, i) = (row / n, row % n);
                    (0..block).map(|k| table[(m * block + k) * n + i]).sum::<f64>() / block as f64
                })
                .collect()
        };
        for (j, &id) in by.iter().enumerate().step_by(5) {
            let value = arm.truth.get(id);
            // Rows of positions and of torque that are not central differences of two simulations `h` apart.
            let apart = |h: f64| -> Vec<(usize, usize, f64, f64)> {
                let at = |step: f64| {
                    let mut moved = arm.truth.clone();
                    moved.set(id, value + step);
                    known.motion(&moved, &Unobserved).unwrap()
                };
                let (low, high) = (at(-h), at(h));
                let mut apart = Vec::new();
                for (table, (exact, low, high)) in [
                    (&slopes.q, means(&low.states.q), means(&high.states.q)),
                    (&slopes.tau, means(&low.tau), means(&high.tau)),
                ]
                .into_iter()
                .enumerate()
                {
                    let size = exact.column(j).amax();
                    let rounding = low.iter().fold(1.0_f64, |most, x| most.max(x.abs())) * 4e-15 / h;
                    assert!(size > 0.0, "{name} {id}");
                    for (row, (low, high)) in low.iter().zip(&high).enumerate() {
                        let (difference, found) = ((high - low) / (2.0 * h), exact[(row, j)]);
                        if (difference - found).abs() >= 2e-5 * size + rounding {
                            apart.push((table, row, difference, found));
                        }
                    }
                }
                apart
            };
            // A step that is neither lost in rounding nor in curvature. Where some step of the simulation is divided into one part more
            // between the two, there is no derivative: a shorter step has the change outside.
            let h = 1e-5 * value.abs().max(0.1);
            let mut rows = apart(h);
            if !rows.is_empty() {
                let shorter = apart(h / 8.0);
                rows.retain(|row| shorter.iter().any(|other| (other.0, other.1) == (row.0, row.1)));
            }
            assert!(rows.is_empty(), "{name} {id}: table, row, difference, derivative: {rows:?}");
        }
    }
}

const SIMULATING: [EstimatorKind; 6] = [
    EstimatorKind::Iv,
    EstimatorKind::Didim,
    EstimatorKind::Clie,
    EstimatorKind::Cloe,
    EstimatorKind::PcIv,
    EstimatorKind::PcDidim,
];

#[test]
fn identity_ideal_recordings_give_the_true_parameters() {
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&slow(&arm.robot), Sensing::ideal(), 0);
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let errors: Vec<(&str, f64, Termination)> = SIMULATING
        .iter()
        .map(|&kind| {
            let found = arm.estimate(kind, &recording, &samples);
            (kind.name(), arm.error(&found), found.termination)
        })
        .collect();
    // What processing leaves of the position is in the regressor of `iv`, and in the offsets that `cloe` takes from torque.
    for (name, error, termination) in &errors {
        let most = match *name {
            "clie" => 1e-8,
            // Its steps end when they move torque by 1e-9 of it, each a third of the one before.
            "didim" => 1e-6,
            "pc-didim" => 1e-5,
            _ => 2e-2,
        };
        assert!(*error < most && termination.was_successful(), "{errors:?}");
    }
}

#[test]
fn a_servo_a_motion_or_a_guess_that_is_not_known_is_named() {
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&short(&arm.robot), Sensing::ideal(), 0);
    let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
    let (before, rest) = entry.robot.split_once("[servo]").unwrap();
    let (_, after) = rest.split_once("[[joint]]").unwrap();
    let mute = parse_robot(&format!("{before}[[joint]]{after}")).unwrap();
    let of = |robot: &Robot, nominal, recordings: &[Option<&Recording>]| {
        closed_loop_of(Some(closed_loop), robot, nominal, recordings).unwrap_err()
    };
    let robot = "planar-2r".to_owned();
    assert_eq!(of(&mute, Some(&arm.nominal), &[Some(&recording)]), ClosedLoopError::NoServo { robot: robot.clone() });
    assert_eq!(of(&arm.robot, None, &[Some(&recording)]), ClosedLoopError::NoNominal { robot });
    assert_eq!(of(&arm.robot, Some(&arm.nominal), &[None]), ClosedLoopError::NoReference);
    assert_eq!(
        closed_loop_of(None, &arm.robot, Some(&arm.nominal), &[Some(&recording)]).unwrap_err(),
        ClosedLoopError::NotGiven
    );
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let observation = Observation::new(&arm.robot, &arm.regressor, &arm.base, &samples).unwrap();
    let missing = ClosedLoopError::NoReference;
    let problem = EstimationProblem {
        robot: Some(&arm.robot),
        samples: Some(&samples),
        closed_loop: Err(&missing),
        ..EstimationProblem::new(&observation)
    };
    for kind in SIMULATING {
        let found = kind.estimator().estimate(&problem).unwrap_err();
        assert_eq!(found, EstimationError::ClosedLoop { estimator: kind.name().into(), reason: missing.clone() });
    }
}

#[test]
fn an_arm_that_cannot_move_so_is_refused_and_no_panic() {
    let arm = Arm::new("planar-2r");
    let known = closed_loop(&arm.robot, &arm.nominal, ClosedLoopReference::Plans(&[short(&arm.robot)])).unwrap();
    let beta = arm.beta() * -1.0;
    let against = complete(&arm.base, &beta, &arm.nominal).unwrap().parameters;
    assert!(matches!(known.motion(&against, &Unobserved), Err(ClosedLoopError::MassMatrix { .. })));
    // So little inertia that the servo, whose gains are those of the nominal one, is unstable.
    let light = complete(&arm.base, &(arm.beta() * 1e-3), &arm.nominal).unwrap().parameters;
    let found = known.motion(&light, &Unobserved).unwrap_err();
    assert!(found.is_of_parameters(), "{found}");
    let one = [arm.base.parameters[arm.base.kept[0]]];
    assert_eq!(known.slopes(&light, &one, 10, &Unobserved).unwrap_err(), found);
}

#[test]
fn identity_another_base_gives_the_same_torque() {
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&short(&arm.robot), Sensing::default(), 3);
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let own = arm.estimate(EstimatorKind::Didim, &recording, &samples);
    let other = Arm { base: reduce(&arm.robot, COLUMNS, Method::Qr, Seed::new(2)).unwrap(), ..Arm::new("planar-2r") };
    let found = other.estimate(EstimatorKind::Didim, &recording, &samples);
    let states = table_states(&arm.robot);
    let torque =
        |arm: &Arm, estimate: &Estimate| arm.base.select_columns(&arm.regressor.stack(&states)) * estimate.beta();
    let (a, b) = (torque(&arm, &own), torque(&other, &found));
    assert!((&a - &b).amax() < 1e-7 * a.amax(), "{}", (&a - &b).amax());
}

#[test]
fn analytic_intervals_hold_the_truth_on_a_noisy_recording_of_the_a460() {
    let arm = Arm::new("crs-a460");
    let plan = ExperimentPlan {
        settle_s: 0.1,
        ramp_s: 1.0,
        rate_hz: 500.0,
        ..ExperimentPlan::new(gentle(&arm.robot, 5.0, 0.8)).with_periods(8)
    };
    let recording = arm.record(&plan, Sensing::default(), 1);
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let beta = arm.beta();
    let mut seen = Vec::new();
    for kind in SIMULATING {
        let found = arm.estimate(kind, &recording, &samples);
        // The integral of this servo takes up every offset.
        let hidden = found.findings.iter().find_map(|finding| match finding {
            Finding::HiddenFromPositions { combinations, parameters, nominal: false } => {
                Some((*combinations, parameters.clone()))
            }
            _ => None,
        });
        let offsets: Vec<String> = (1..=6).map(|joint| format!("Fo{joint}")).collect();
        assert_eq!(hidden, (kind == EstimatorKind::Cloe).then_some((6, offsets)));
        let held = |p: &armid::estimation::BaseEstimate, truth: f64| p.ci95[0] <= truth && truth <= p.ci95[1];
        let share =
            found.base.iter().zip(&beta).filter(|(p, truth)| held(p, **truth)).count() as f64 / beta.len() as f64;
        seen.push((kind.name(), share, arm.error(&found), found.termination));
    }
    // 58 intervals whose errors are related.
    assert!(seen.iter().all(|(_, share, _, termination)| *share > 0.85 && termination.was_successful()), "{seen:?}");
}

#[test]
fn combinations_that_keep_nominal_values_are_said_to() {
    // Torque of the wrong sign: no arm has the parameters that least squares finds.
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&slow(&arm.robot), Sensing::ideal(), 0);
    let mut samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    samples.tau.iter_mut().for_each(|tau| *tau = -*tau);
    let found = arm.estimate(EstimatorKind::Cloe, &recording, &samples);
    let hidden = found.findings.iter().find(|finding| matches!(finding, Finding::HiddenFromPositions { .. })).unwrap();
    assert!(matches!(hidden, Finding::HiddenFromPositions { nominal: true, .. }), "{hidden}");
    assert!(hidden.to_string().contains("nominal values") && hidden.advice().contains("do not use"), "{hidden}");
}

#[test]
fn torque_of_another_unit_is_not_that_of_the_robot_s_servo() {
    // The exception that these estimators declare: others find parameters twice as large.
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&slow(&arm.robot), Sensing::ideal(), 0);
    let mut samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    samples.tau.iter_mut().for_each(|tau| *tau *= 2.0);
    let error = |kind| {
        let found = arm.estimate(kind, &recording, &samples);
        (found.beta() - arm.beta() * 2.0).norm() / arm.beta().norm()
    };
    let linear = error(EstimatorKind::Wls);
    assert!(linear < 0.01, "{linear}");
    for kind in [EstimatorKind::Didim, EstimatorKind::Clie] {
        assert!(error(kind) > 2.0 * linear, "{}: {} {linear}", kind.name(), error(kind));
    }
}

fn table_states(robot: &Robot) -> armid::dynamics::States {
    gentle(robot, 2.0, 0.5).sample(50)
}

#[test]
fn the_test_of_the_motion_s_errors_is_a_finding_of_instruments() {
    let arm = Arm::new("planar-2r");
    let recording = arm.record(&short(&arm.robot), Sensing::default(), 4);
    let samples = process(&recording, &arm.robot, &Processing::default()).unwrap();
    let found = arm.estimate(EstimatorKind::Iv, &recording, &samples);
    let tests = found.findings.iter().filter(|finding| matches!(finding, Finding::DurbinWuHausman { .. }));
    assert_eq!(tests.count(), 1, "{:?}", found.findings);
}
