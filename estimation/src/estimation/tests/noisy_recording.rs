//! Every estimator on noisy recordings of the A460, and of a motion whose states have noise too.

use nalgebra::{DMatrix, DVector, Matrix3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::coverage::Coverage;
use super::setting::{a460_samples, white};
use crate::base::{Method, reduce};
use crate::chains;
use crate::dynamics::{Dynamics, States};
use crate::estimation::StiffLoop;
use crate::estimation::{EstimationProblem, EstimatorKind, Finding, Observation};
use crate::model::Columns;
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};
use crate::spatial::Inertia;

/// Deviation of a joint under the servo of estimators that simulate, rad per N·m, and noise of positions, rad: too little to
/// matter to any other.
const COMPLIANCE: f64 = 1e-6;
const POSITION_NOISE: f64 = 1e-9;

#[test]
fn analytic_coverage_of_every_estimator_on_the_a460() {
    let (robot, parameters, regressor, base, exact) = a460_samples(100);
    let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
    let std: Vec<f64> = robot.joints().iter().map(|j| j.drive.current_noise * j.drive.torque_per_ampere()).collect();
    let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, std.iter().map(|s| s * s)));
    let mut guess = parameters.clone();
    guess.links = guess.links.iter().map(|link| Inertia::from_array(&link.to_array().map(|x| 0.8 * x))).collect();
    let stiff =
        StiffLoop::new(&robot, regressor.columns(), &parameters, guess.clone(), exact.states.clone(), COMPLIANCE);
    for kind in EstimatorKind::ALL {
        let mut coverage = Coverage::new(base.rank());
        for run in 0..8 {
            let mut samples = exact.clone();
            let mut positions = Seed::new(97).stream("positions", run);
            samples.states.q.iter_mut().for_each(|q| *q += POSITION_NOISE * normal(&mut positions));
            let noise = white(&covariance, 100, &mut Seed::new(95).stream("noise", run));
            for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
                *tau += noise;
            }
            samples.noise = Some(NoiseModel::white(covariance.clone(), true, 1e9));
            let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
            let problem = EstimationProblem {
                robot: Some(&robot),
                samples: Some(&samples),
                ..EstimationProblem::new(&observation)
            };
            let problem = EstimationProblem { nominal: Some(&guess), closed_loop: Ok(&stiff), ..problem };
            let estimate = kind.estimator().estimate(&problem).unwrap();
            assert!(estimate.termination.was_successful(), "{}: {:?}", kind.name(), estimate.termination);
            coverage.add(&estimate, &beta);
        }
        // 464 intervals whose errors are related: an honest share has a standard deviation of some 2 %.
        let share = coverage.pooled();
        assert!((0.87..=1.0).contains(&share), "{}: {share}", kind.name());
    }
}

/// Noise of (q, q̇, q̈) of a joint whose positions are white over the band up to `band_hz`.
fn motion_covariance(std: f64, band_hz: f64, rate_hz: f64) -> Matrix3<f64> {
    let omega = std::f64::consts::TAU * band_hz;
    let q = std * std * band_hz / (0.5 * rate_hz);
    let (qd, qdd) = (q * omega.powi(2) / 3.0, q * omega.powi(4) / 5.0);
    Matrix3::new(q, 0.0, -qd, 0.0, qd, 0.0, -qd, 0.0, qdd)
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[test]
fn analytic_noise_of_the_motion_biases_weighted_and_not_total_least_squares() {
    let seed = Seed::new(96);
    let (dof, count) = (3, 600);
    let (robot, truth) = chains::random_robot(&mut seed.stream("robot", 0), dof);
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
    let base = reduce(&robot, columns, Method::Structural, seed).unwrap();
    let beta = base.beta(&truth.vector(&robot, columns));
    let (std, band, rate) = (1.5e-2, 5.0, 100.0);
    let root = motion_covariance(std, band, rate).cholesky().unwrap().l();
    let sigma = 0.05;
    let runs = 12;
    let kinds = [EstimatorKind::Wls, EstimatorKind::Tls, EstimatorKind::Ml];
    let mut bias = vec![DVector::<f64>::zeros(beta.len()); kinds.len()];
    let mut spread = DVector::<f64>::zeros(beta.len());
    for run in 0..runs {
        let mut rng = seed.stream("run", run);
        let (mut states, mut tau) = (States::new(dof), Vec::new());
        for _ in 0..count {
            let (mut q, mut qd, mut qdd) = chains::random_state(&mut rng, dof);
            let mut one = vec![0.0; dof];
            Dynamics::new(&robot, &truth).inverse(&q, &qd, &qdd, &mut one);
            tau.extend(one.iter().map(|tau| tau + sigma * normal(&mut rng)));
            for j in 0..dof {
                let error = root * nalgebra::Vector3::from_fn(|_, _| normal(&mut rng));
                q[j] += error[0];
                qd[j] += error[1];
                qdd[j] += error[2];
            }
            states.push(&q, &qd, &qdd);
        }
        let covariance = DMatrix::identity(dof, dof) * (sigma * sigma);
        let samples = Samples {
            position_noise: Some(vec![std; dof]),
            position_band_hz: vec![band; dof],
            noise: Some(NoiseModel::white(covariance, false, 1e6)),
            ..Samples::exact(states, tau, vec!["N·m".to_owned(); dof], rate)
        };
        let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
        let problem =
            EstimationProblem { robot: Some(&robot), samples: Some(&samples), ..EstimationProblem::new(&observation) };
        for (kind, bias) in kinds.iter().zip(&mut bias) {
            let estimate = kind.estimator().estimate(&problem).unwrap();
            assert!(estimate.termination.was_successful(), "{}: {:?}", kind.name(), estimate.termination);
            *bias += (estimate.beta() - &beta) / runs as f64;
            if *kind == EstimatorKind::Tls {
                spread += estimate.std() / runs as f64;
            }
        }
    }
    let size = |bias: &DVector<f64>| bias.component_div(&spread).norm() / (beta.len() as f64).sqrt();
    let sizes: Vec<f64> = bias.iter().map(size).collect();
    // A mean of 12 runs has 0.29 standard deviations of its own.
    assert!(sizes[0] > 1.0 && sizes[1..].iter().all(|size| *size < 0.6 && *size < 0.5 * sizes[0]), "{sizes:?}");
}

#[test]
fn the_exception_of_essential_parameters_is_what_it_says() {
    // Exact equations that state noise: what the noise would hide is left out, its interval holds the truth all the same.
    let (robot, parameters, regressor, base, mut samples) = a460_samples(100);
    let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
    let std = robot.joints().iter().map(|j| 20.0 * j.drive.current_noise * j.drive.torque_per_ampere());
    let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, std.map(|s| s * s)));
    samples.noise = Some(NoiseModel::white(covariance, true, 1e9));
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let found = EstimatorKind::Essential.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
    let mut left_out = 0;
    for (p, truth) in found.base.iter().zip(beta.iter()) {
        let is_told = |f: &Finding| matches!(f, Finding::LeftOut { parameter, .. } if *parameter == p.name);
        assert_eq!(p.value == 0.0, found.findings.iter().any(is_told), "{}", p.name);
        assert!(p.ci95[0] <= *truth && *truth <= p.ci95[1], "{}", p.name);
        left_out += usize::from(p.value == 0.0);
    }
    assert!((1..58).contains(&left_out), "{left_out}");
}

#[test]
fn analytic_random_points_have_the_estimate_of_the_kalman_filter_but_for_what_they_miss() {
    let (robot, _, regressor, base, mut samples) = a460_samples(100);
    let std = robot.joints().iter().map(|j| j.drive.current_noise * j.drive.torque_per_ampere());
    let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, std.map(|s| s * s)));
    let noise = white(&covariance, 100, &mut Seed::new(97).stream("noise", 0));
    for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
        *tau += noise;
    }
    samples.noise = Some(NoiseModel::white(covariance, true, 1e9));
    let observation = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let estimate = |kind: EstimatorKind| kind.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
    let (points, kalman) = (estimate(EstimatorKind::Pf), estimate(EstimatorKind::Ekf));
    let apart = (points.beta() - kalman.beta()).component_div(&kalman.std()).norm() / (base.rank() as f64).sqrt();
    // Random points they are, so not nearer than 1e-3; what they miss is measured here and said in their documentation.
    assert!((1e-3..0.4).contains(&apart), "{apart}");
    let wider = points.std().component_div(&kalman.std());
    assert!(wider.min() > 0.8 && wider.max() < 1.3, "{} {}", wider.min(), wider.max());
}
