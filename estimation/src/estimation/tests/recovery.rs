//! Exact data gives exact parameters, and two routes the same estimate.

use nalgebra::{DMatrix, DVector};

use super::setting::{a460, a460_samples, synthetic, white};
use crate::base::{Method, reduce};
use crate::chains;
use crate::dynamics::{Dynamics, States};
use crate::estimation::StiffLoop;
use crate::estimation::{
    Estimate, EstimationError, EstimationProblem, EstimatorKind, Finding, Identification, Inference, Instruments,
    IntervalBasis, Observation, Termination, complete, predict, residual_noise, validate,
};
use crate::model::Columns;
use crate::model::term::STRIBECK;
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};
use crate::spatial::Inertia;

/// Estimators that need the servo.
const SIMULATING: [EstimatorKind; 6] = [
    EstimatorKind::Iv,
    EstimatorKind::Didim,
    EstimatorKind::Clie,
    EstimatorKind::Cloe,
    EstimatorKind::PcIv,
    EstimatorKind::PcDidim,
];

#[test]
fn identity_exact_states_give_the_base_parameters_of_the_a460() {
    let (robot, parameters, regressor, base, samples) = a460_samples(200);
    assert_eq!(base.rank(), 58);
    let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let mut guess = parameters.clone();
    guess.links = guess.links.iter().map(|link| Inertia::from_array(&link.to_array().map(|x| 0.9 * x))).collect();
    let columns = regressor.columns();
    let stiff = StiffLoop::new(&robot, columns, &parameters, guess.clone(), samples.states.clone(), 1e-5);
    for kind in EstimatorKind::ALL {
        let problem =
            EstimationProblem { robot: Some(&robot), samples: Some(&samples), ..EstimationProblem::new(&observation) };
        let problem = EstimationProblem { nominal: Some(&guess), closed_loop: Ok(&stiff), ..problem };
        let estimate = kind.estimator().estimate(&problem).unwrap();
        let error = (estimate.beta() - &beta).norm() / beta.norm();
        assert!(error < 1e-8, "{}: {error:e}", kind.name());
        let predicted = predict(&estimate, &regressor, &samples.states).unwrap();
        for (p, tau) in predicted.iter().zip(&samples.tau) {
            assert!((p - tau).abs() < 1e-8);
        }
        let validation = validate(&estimate, &regressor, &samples).unwrap();
        assert!(validation.is_within(1e-9) && validation.rms.len() == 6);
    }
}

#[test]
fn a_joint_at_rest_leaves_the_others_to_every_estimator() {
    // Without periods the noise is that of the residual, and the joint at rest has no equation and so no residual.
    let (robot, parameters, _, _, samples) = a460_samples(300);
    let mut samples = samples.with_joints_at_rest(&[4]);
    let mut dynamics = Dynamics::new(&robot, &parameters);
    let (states, noise) = (samples.states.clone(), DMatrix::identity(6, 6) * 1e-4);
    for (k, tau) in samples.tau.chunks_exact_mut(6).enumerate() {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
    }
    let noise = white(&noise, 300, &mut Seed::new(33).stream("noise", 0));
    for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
        *tau += noise;
    }
    let known =
        Identification::on_motion(&robot, Columns::RIGID_ROTOR_FRICTION, &samples).unwrap().with_nominal(&parameters);
    assert!((30..58).contains(&known.base().rank()), "{}", known.base().rank());
    for kind in EstimatorKind::ALL.iter().filter(|kind| !SIMULATING.contains(kind)) {
        let found =
            known.estimate(&samples, kind.estimator()).unwrap_or_else(|fault| panic!("{}: {fault}", kind.name()));
        assert!(found.residual_rms.iter().all(|rms| *rms < 1.0), "{}: {:?}", kind.name(), found.residual_rms);
    }
}

#[test]
fn identity_exact_states_give_the_base_parameters_of_random_chains() {
    let seed = Seed::new(31);
    for run in 0..20 {
        let mut rng = seed.stream("chains", run);
        let dof = 2 + usize::try_from(run % 5).unwrap();
        let (robot, parameters) = chains::random_robot(&mut rng, dof);
        let columns = Columns::ALL[usize::try_from(run % 3).unwrap()];
        let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
        let base = reduce(&robot, columns, Method::Structural, seed).unwrap();
        let mut states = States::new(dof);
        for _ in 0..60 {
            let (q, qd, qdd) = chains::random_state(&mut rng, dof);
            states.push(&q, &qd, &qdd);
        }
        let phi = parameters.vector(&robot, columns);
        let known = crate::model::StandardParameters::from_vector(&robot, columns, phi.as_slice());
        let mut dynamics = Dynamics::new(&robot, &known);
        let mut tau = vec![0.0; 60 * dof];
        for (k, tau) in tau.chunks_exact_mut(dof).enumerate() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        }
        let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); dof], 10.0);
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let estimate = EstimatorKind::Ols.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
        let beta = base.beta(&phi);
        let error = (estimate.beta() - &beta).norm() / beta.norm();
        assert!(error < 1e-8, "chain {run}: {error:e}");
    }
}

fn noisy(covariance: &DMatrix<f64>) -> Observation {
    let seed = Seed::new(32);
    let (mut observation, _) = synthetic(80, 7, &mut seed.stream("regressor", 0));
    observation.y += white(covariance, 80, &mut seed.stream("noise", 0));
    observation.noise = Some(NoiseModel::white(covariance.clone(), false, 1e9));
    observation.periods = 10;
    observation
}

fn estimate(kind: EstimatorKind, observation: &Observation) -> Estimate {
    kind.estimator().estimate(&EstimationProblem::new(observation)).unwrap()
}

#[test]
fn identity_both_estimators_agree_on_equal_noise_and_with_the_pseudo_inverse() {
    let observation = noisy(&(DMatrix::identity(2, 2) * 0.09));
    let (ols, wls) = (estimate(EstimatorKind::Ols, &observation), estimate(EstimatorKind::Wls, &observation));
    let inverse = observation.regressor.clone().pseudo_inverse(1e-14).unwrap();
    let expected = &inverse * &observation.y;
    let covariance = &inverse * inverse.transpose() * 0.09;
    for e in [&ols, &wls] {
        assert!((e.beta() - &expected).norm() < 1e-12 * expected.norm());
        assert!((e.covariance_matrix() - &covariance).norm() < 1e-12 * covariance.norm());
    }
    assert!(ols.findings.is_empty(), "{:?}", ols.findings);
}

#[test]
fn identity_weights_by_the_full_block_matrix() {
    let sigma = nalgebra::dmatrix![0.04, 0.012; 0.012, 0.01];
    let observation = noisy(&sigma);
    let wls = estimate(EstimatorKind::Wls, &observation);
    let precision = sigma.clone().try_inverse().unwrap();
    let mut whole = DMatrix::zeros(160, 160);
    for k in 0..80 {
        whole.view_mut((2 * k, 2 * k), (2, 2)).copy_from(&precision);
    }
    let w = &observation.regressor;
    let covariance = (w.transpose() * &whole * w).try_inverse().unwrap();
    let expected = &covariance * w.transpose() * whole * &observation.y;
    assert!((wls.beta() - &expected).norm() < 1e-12 * expected.norm());
    assert!((wls.covariance_matrix() - &covariance).norm() < 1e-12 * covariance.norm());
    // The scale of Σ is that of the error bars and nothing else.
    let mut doubled = observation.clone();
    doubled.noise = Some(NoiseModel::white(&sigma * 4.0, false, 1e9));
    let twice = estimate(EstimatorKind::Wls, &doubled);
    assert!((twice.beta() - wls.beta()).norm() < 1e-12);
    assert!((twice.std() - wls.std() * 2.0).norm() < 1e-12);
}

#[test]
fn identity_units_of_torque_and_of_parameters_do_not_matter_to_weighted_least_squares() {
    let sigma = nalgebra::dmatrix![0.04, 0.012; 0.012, 0.01];
    let observation = noisy(&sigma);
    let plain = estimate(EstimatorKind::Wls, &observation);
    let mut scaled = observation.clone();
    let factors = DMatrix::from_diagonal(&DVector::from_vec(vec![100.0, 0.01]));
    for row in 0..160 {
        scaled.regressor.row_mut(row).scale_mut(factors[(row % 2, row % 2)]);
        scaled.y[row] *= factors[(row % 2, row % 2)];
    }
    for j in 0..7 {
        scaled.regressor.column_mut(j).scale_mut(libm::pow(10.0, j as f64 - 3.0));
    }
    scaled.noise = Some(NoiseModel::white(&factors * sigma * &factors, false, 1e9));
    let other = estimate(EstimatorKind::Wls, &scaled);
    for j in 0..7 {
        let unit = libm::pow(10.0, j as f64 - 3.0);
        assert!((other.base[j].value * unit / plain.base[j].value - 1.0).abs() < 1e-10);
        assert!((other.base[j].std * unit / plain.base[j].std - 1.0).abs() < 1e-10);
    }
    assert!((other.condition_scaled / plain.condition_scaled - 1.0).abs() < 1e-9);
}

#[test]
fn findings_carry_what_was_measured() {
    let sigma = DMatrix::identity(2, 2) * 1e-4;
    let mut observation = noisy(&sigma);
    observation.periods = 2;
    for k in 0..80 {
        observation.y[2 * k + 1] += 0.5 * libm::sin(0.2 * f64::from(u8::try_from(k).unwrap()));
    }
    let estimate = estimate(EstimatorKind::Ols, &observation);
    assert!(estimate.findings.contains(&Finding::FewPeriods { periods: 2 }));
    let ratio = estimate.findings.iter().find_map(|finding| match finding {
        Finding::ResidualAboveNoise { joint: 2, ratio, .. } => Some(*ratio),
        _ => None,
    });
    // 0.5/√2 against a noise of 0.01.
    assert!((ratio.unwrap() / 35.0 - 1.0).abs() < 0.15, "{:?}", estimate.findings);
    let correlated = estimate.findings.iter().any(
        |finding| matches!(finding, Finding::ResidualCorrelated { joint: 2, correlation, .. } if *correlation > 0.8),
    );
    assert!(correlated, "{:?}", estimate.findings);
    for finding in &estimate.findings {
        assert!(!finding.to_string().is_empty() && !finding.advice().is_empty());
    }
    let json = serde_json::to_string(&estimate).unwrap();
    assert_eq!(serde_json::from_str::<Estimate>(&json).unwrap(), estimate);
}

#[test]
fn identity_completion_keeps_the_base_parameters_and_the_nominal_set_where_it_agrees() {
    let (robot, nominal) = a460();
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let phi = nominal.vector(&robot, columns);
    let same = complete(&base, &base.beta(&phi), &nominal).unwrap();
    assert!((same.parameters.vector(&robot, columns) - &phi).norm() < 1e-12);
    assert!(same.findings.is_empty(), "{:?}", same.findings);
    let mut beta = base.beta(&phi);
    for (j, value) in beta.iter_mut().enumerate() {
        *value += 0.1 * libm::sin(j as f64);
    }
    let other = complete(&base, &beta, &nominal).unwrap();
    let changed = other.parameters.vector(&robot, columns);
    assert!((base.beta(&changed) - &beta).norm() < 1e-11);
    // The smallest change lies in the span of K's rows.
    let change = &changed - &phi;
    let k_t = base.k.transpose();
    let inside = &k_t * (&base.k * &k_t).try_inverse().unwrap() * (&base.k * &change);
    assert!((inside - &change).norm() < 1e-11 * change.norm());
    assert!(matches!(
        complete(&base, &DVector::zeros(3), &nominal),
        Err(EstimationError::Count { quantity: "base parameters", .. })
    ));
}

#[test]
fn a_parameter_that_is_not_excited_is_named() {
    let (robot, _, regressor, base, samples) = a460_samples(100);
    let mut still = samples.clone();
    for k in 0..still.len() {
        still.states.qd[6 * k + 5] = 0.0;
        still.states.qdd[6 * k + 5] = 0.0;
        still.states.q[6 * k + 5] = 0.3;
    }
    let observation = Observation::new(&robot, &regressor, &base, &still).unwrap();
    let outcome = EstimatorKind::Ols.estimator().estimate(&EstimationProblem::new(&observation));
    assert!(matches!(outcome, Err(EstimationError::NotExcited { .. })), "{outcome:?}");
    let few = Samples::exact(States::with_len(6, 5), vec![0.0; 30], vec!["N·m".to_owned(); 6], 1.0);
    assert!(matches!(
        Observation::new(&robot, &regressor, &base, &few),
        Err(EstimationError::TooFewEquations { equations: 30, parameters: 58 })
    ));
}

#[test]
fn a_parameter_that_acts_where_no_equation_is_is_named() {
    // Friction of Stribeck acts at a standstill; equations within 0.3 rad/s of it, three times its speed, are left out.
    let (robot, ..) = a460();
    let columns = Columns::RIGID_ROTOR_FRICTION.with_term(STRIBECK);
    let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let (.., mut samples) = a460_samples(500);
    assert!(Observation::new(&robot, &regressor, &base, &samples).is_ok());
    for (row, used) in samples.used.iter_mut().enumerate() {
        *used = samples.states.qd[row].abs() > 0.3;
    }
    let found = Observation::new(&robot, &regressor, &base, &samples);
    assert!(
        matches!(&found, Err(EstimationError::OutsideOfEquations { parameter, share }) if parameter.starts_with("Fs") && *share < 1e-3),
        "{found:?}"
    );
}

#[test]
fn what_an_iteration_did_not_come_to_is_a_finding() {
    let (_, _, regressor, base, samples) = a460_samples(100);
    let (robot, _) = a460();
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let problem = EstimationProblem::new(&observation);
    let equations = problem.factorised().unwrap();
    let fit = equations.least_squares().unwrap();
    let noise = residual_noise(&observation, &observation.residual(fit.solution()));
    let of = |termination| {
        let estimator = "ols";
        let (instruments, basis) = (Instruments::Regressor, IntervalBasis::Residual);
        Inference { estimator, problem: &problem, fit, instruments, noise: &noise, basis, termination }
            .estimate()
            .unwrap()
    };
    let is_said = |termination| {
        let findings = of(termination).findings;
        findings
            .iter()
            .any(|finding| matches!(finding, Finding::Unfinished { .. }) && finding.advice().contains("do not use"))
    };
    assert!(!is_said(Termination::Direct) && !is_said(Termination::Converged { iterations: 3, last_step: 0.0 }));
    assert!(is_said(Termination::IterationLimit { iterations: 50, last_step: 0.1 }));
    assert!(
        is_said(Termination::Unsimulable { iterations: 2 })
            && is_said(Termination::Stalled { iterations: 2, last_step: 0.1 })
    );
}
