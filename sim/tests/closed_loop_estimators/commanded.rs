//! Joints that were commanded positions, by servos that are not known in full.

use std::f64::consts::TAU;

use armid::dynamics::States;
use armid::estimation::{
    ClosedLoopError, ClosedLoopReference, Estimate, EstimationError, EstimationProblem, EstimatorKind, Observation,
    PositionServo, ServoPart,
};
use armid::experiment::Plant;
use armid::observer::Unobserved;
use armid::seed::Seed;
use armid::signal::Samples;
use armid_sim::{AnalyticPlant, closed_loop};
use nalgebra::DVector;
use rand::RngExt;

use crate::arm::Arm;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 1200;
/// Steps of the arm in a sample.
const STEPS: usize = 50;
/// Noise of the encoders, rad.
const NOISE: f64 = 5e-5;

fn command(t: f64) -> [f64; 2] {
    let wave = |size: f64, hz: f64, phase: f64| size * (TAU * hz * t + phase).sin();
    [wave(0.5, 0.5, 0.0) + wave(0.25, 1.3, 1.0) - 0.4, wave(0.6, 0.7, 0.3) + wave(0.2, 1.9, 0.0) + 0.2]
}

/// What the servos are.
fn truth() -> PositionServo {
    PositionServo { zero: vec![0.05, 0.0], ..PositionServo::new(vec![90.0, 30.0], vec![5.0, 1.5], 0.012) }
}

/// Samples of an arm under those servos, with the torque that `stated` ones would have had.
fn samples(arm: &Arm, stated: &PositionServo, run: u64) -> Samples {
    let (servo, n) = (truth(), 2);
    let mut plant = AnalyticPlant::new(&arm.robot, &arm.truth).unwrap();
    let dt = 1.0 / (RATE_HZ * STEPS as f64);
    let encoder = |q: f64, i: usize| q - servo.value(ServoPart::Zero(i));
    let begin = command(-servo.delay_s);
    plant.reset(&[begin[0] + servo.zero[0], begin[1]], &[0.0; 2]);
    let mut noise = Seed::new(7).stream("encoders", run);
    let mut states = States { dof: n, q: Vec::new(), qd: Vec::new(), qdd: Vec::new() };
    let (mut tau, mut before) = (Vec::new(), [0.0; 2]);
    for step in 0..SAMPLES * STEPS {
        let t = step as f64 * dt;
        let (q, qd) = plant.state();
        let (q, qd) = ([q[0], q[1]], [qd[0], qd[1]]);
        if step % STEPS == 0 {
            let told = command(t - stated.delay_s);
            let measured = [0, 1].map(|i| encoder(q[i], i) + NOISE * 3.0_f64.sqrt() * noise.random_range(-1.0..1.0));
            tau.extend((0..n).map(|i| stated.kp[i] * (told[i] - measured[i]) - stated.kd[i] * qd[i]));
            states.q.extend(measured);
            states.qd.extend(qd);
            states.qdd.extend([0, 1].map(|i| (qd[i] - before[i]) / dt));
        }
        // At the state that is expected in the middle of the step.
        let told = command(t + 0.5 * dt - servo.delay_s);
        let held = [0, 1].map(|i| {
            let (q, qd) = (encoder(q[i], i) + 0.5 * dt * qd[i], qd[i] + 0.5 * (qd[i] - before[i]));
            servo.kp[i] * (told[i] - q) - servo.kd[i] * qd
        });
        before = qd;
        plant.step(&held, dt).unwrap();
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); n], RATE_HZ)
}

fn estimate(arm: &Arm, stated: &PositionServo, run: u64, kind: EstimatorKind) -> Result<Estimate, EstimationError> {
    let samples = samples(arm, stated, run);
    let observation = Observation::new(&arm.robot, &arm.regressor, &arm.base, &samples)?;
    let reference = ClosedLoopReference::Commands(stated, std::slice::from_ref(&samples));
    let known = closed_loop(&arm.robot, &arm.nominal, reference).unwrap();
    let problem = EstimationProblem {
        robot: Some(&arm.robot),
        samples: Some(&samples),
        nominal: Some(&arm.nominal),
        closed_loop: Ok(&*known),
        ..EstimationProblem::new(&observation)
    };
    kind.estimator().estimate(&problem)
}

/// A guess of the servos that is wrong where it is unknown.
fn guess(unknown: Vec<ServoPart>) -> PositionServo {
    let true_servo = truth();
    let wrong: Vec<f64> = unknown
        .iter()
        .map(|part| match part {
            ServoPart::Delay | ServoPart::Zero(_) => 0.0,
            ServoPart::Stiffness(_) | ServoPart::Damping(_) => 0.8 * true_servo.value(*part),
        })
        .collect();
    PositionServo { unknown, zero: Vec::new(), ..true_servo }.with_unknown(&wrong)
}

#[test]
fn identity_a_stiffness_a_delay_and_a_zero_are_found_beside_the_arm() {
    let arm = Arm::new("planar-2r");
    let stated = guess(vec![ServoPart::Stiffness(1), ServoPart::Delay, ServoPart::Zero(0)]);
    let found = estimate(&arm, &stated, 0, EstimatorKind::Cloe).unwrap();
    assert!(found.termination.was_successful(), "{:?}", found.termination);
    let names: Vec<&str> = found.servo.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["kp2", "delay", "zero1"]);
    for (part, wanted) in found.servo.iter().zip([30.0, 0.012, 0.05]) {
        assert!((part.value - wanted).abs() < 4.0 * part.std && part.std < 0.1 * wanted, "{part:?}");
    }
    let beta = arm.beta();
    for (parameter, wanted) in found.base.iter().zip(&beta) {
        assert!((parameter.value - wanted).abs() < 4.5 * parameter.std, "{parameter:?} {wanted}");
    }
    // By the servos that were found, torque is what the arm needs.
    assert!(found.residual_rms.iter().all(|rms| *rms < 0.02), "{:?}", found.residual_rms);
}

#[test]
fn analytic_what_the_motion_does_not_show_of_a_servo_is_refused_with_the_reason() {
    let arm = Arm::new("planar-2r");
    let hidden = |unknown: Vec<ServoPart>| match estimate(&arm, &guess(unknown), 1, EstimatorKind::Cloe).unwrap_err() {
        EstimationError::ClosedLoop { reason: ClosedLoopError::ServoHidden { part, with }, .. } => (part, with),
        other => panic!("{other}"),
    };
    // Twice the gains and twice the inertias; damping is viscous friction; a turned link behind the last encoder.
    let (part, with) = hidden(vec![ServoPart::Stiffness(0), ServoPart::Stiffness(1)]);
    assert!(part.starts_with("kp") && with.len() > 3, "{part} {with:?}");
    assert_eq!(hidden(vec![ServoPart::Damping(1)]), ("kd2".to_owned(), vec!["Fv2".to_owned()]));
    let (part, with) = hidden(vec![ServoPart::Zero(1)]);
    assert_eq!(part, "zero2");
    assert!(!with.is_empty() && with.iter().all(|name| name.ends_with('2')), "{with:?}");
    let message = ClosedLoopError::ServoHidden { part, with }.to_string();
    assert!(message.contains("the motion does not show zero2 of the servo"), "{message}");
    // Estimators that need the servo say so.
    for kind in [EstimatorKind::Clie, EstimatorKind::Iv] {
        let found = estimate(&arm, &guess(vec![ServoPart::Delay]), 1, kind).unwrap_err();
        let reason = ClosedLoopError::ServoUnknown { parts: vec!["delay".to_owned()] };
        assert_eq!(found, EstimationError::ClosedLoop { estimator: kind.name().to_owned(), reason });
    }
}

#[test]
fn identity_known_servos_and_their_commands_give_the_arm() {
    let arm = Arm::new("planar-2r");
    let encoders = PositionServo { zero: Vec::new(), ..truth() };
    let known = truth();
    for kind in [EstimatorKind::Cloe, EstimatorKind::Clie] {
        // A zero that is known is in the positions.
        let samples = encoders.restated_samples(&samples(&arm, &encoders, 2), &known);
        let reference = ClosedLoopReference::Commands(&known, std::slice::from_ref(&samples));
        let observation = Observation::new(&arm.robot, &arm.regressor, &arm.base, &samples).unwrap();
        let of = closed_loop(&arm.robot, &arm.nominal, reference).unwrap();
        let problem = EstimationProblem {
            robot: Some(&arm.robot),
            samples: Some(&samples),
            closed_loop: Ok(&*of),
            ..EstimationProblem::new(&observation)
        };
        let found = kind.estimator().estimate(&problem).unwrap();
        assert!(arm.error(&found) < 0.02, "{}: {}", kind.name(), arm.error(&found));
    }
}

#[test]
fn identity_slopes_of_a_commanded_loop_are_its_differences() {
    let arm = Arm::new("planar-2r");
    let unknown = vec![ServoPart::Stiffness(1), ServoPart::Damping(0), ServoPart::Delay, ServoPart::Zero(0)];
    let stated = PositionServo { unknown, zero: Vec::new(), ..truth() };
    let samples = samples(&arm, &stated, 3);
    let reference = ClosedLoopReference::Commands(&stated, std::slice::from_ref(&samples));
    let known = closed_loop(&arm.robot, &arm.nominal, reference).unwrap();
    let of = known.commanded().unwrap();
    let by = [arm.base.parameters[arm.base.kept[0]]];
    let (m, block) = (stated.unknown.len(), 20);
    let x: Vec<f64> = [arm.truth.get(by[0])]
        .into_iter()
        .chain(stated.unknown.iter().map(|&part| stated.value(part)))
        .chain(of.starts())
        .collect();
    let at = |x: &[f64]| {
        let mut parameters = arm.truth.clone();
        parameters.set(by[0], x[0]);
        let servo = stated.clone().with_unknown(&x[1..=m]);
        of.slopes_from(&parameters, &servo, &x[1 + m..], &by, block, &Unobserved).unwrap()
    };
    let (_, slopes) = at(&x);
    let means = |values: &[f64]| DVector::from_vec(samples_means(values, block));
    for j in 0..x.len() {
        // Short beside a sample for the delay: its command is a cubic between two.
        let h = if j == 3 { 1e-5 } else { 1e-5 * x[j].abs().max(0.1) };
        let moved = |step: f64| {
            let mut x = x.clone();
            x[j] += step;
            at(&x).0
        };
        let (low, high) = (moved(-h), moved(h));
        for (exact, low, high) in [(&slopes.q, &low.states.q, &high.states.q), (&slopes.tau, &low.tau, &high.tau)] {
            let difference = (means(high) - means(low)) / (2.0 * h);
            let size = exact.column(j).amax();
            let apart = (exact.column(j) - difference).amax();
            assert!(size > 0.0 && apart < 1e-4 * size + 1e-7, "{j}: {apart:e} of {size:e}");
        }
    }
}

/// Means over blocks of a table of two columns.
fn samples_means(values: &[f64], block: usize) -> Vec<f64> {
    let blocks = values.chunks_exact(2 * block);
    blocks.flat_map(|rows| [0, 1].map(|i| rows.iter().skip(i).step_by(2).sum::<f64>() / block as f64)).collect()
}
