//! The factorisation of a recording against all of its rows.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;

use super::setting::{a460_samples, synthetic, white};
use crate::estimation::StiffLoop;
use crate::estimation::{
    Estimate, EstimationError, EstimationProblem, EstimatorKind, Factorisation, FactorisedBy, Finding, Inference,
    Instruments, IntervalBasis, Observation, Termination, residual_noise,
};
use crate::linalg::{BlockWhitening, LeastSquares, LeastSquaresError};
use crate::seed::Seed;
use crate::signal::NoiseModel;

/// Table I of the A460 with noise; joints are no equation for a while, each at times of its own.
fn a460(count: usize) -> (Observation, DMatrix<f64>) {
    let seed = Seed::new(51);
    let (robot, _, regressor, base, mut samples) = a460_samples(count);
    for k in 0..count {
        samples.used[6 * k + 2] = !(100..160).contains(&(k % 500));
        samples.used[6 * k + 4] = !(130..180).contains(&(k % 500));
    }
    let mut rng = seed.stream("covariance", 0);
    let root = DMatrix::from_fn(6, 6, |i, j| {
        let mixed: f64 = rng.random_range(-0.2..0.2);
        (if i == j { 1.0 } else { mixed }) * [1.0, 0.5, 0.4, 0.05, 0.03, 0.02][i]
    });
    let covariance = &root * root.transpose();
    let noise = white(&covariance, count, &mut seed.stream("noise", 0));
    for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
        *tau += noise;
    }
    (Observation::new(&robot, &regressor, &base, &samples).unwrap(), covariance)
}

fn marked_rows(observation: &Observation, w: &DMatrix<f64>, weights: &BlockWhitening) -> DMatrix<f64> {
    weights.clone().whiten(w, &observation.used).unwrap()
}

/// β̂ and `(WᵀW)⁻¹` by the singular value decomposition of all rows.
fn by_decomposition(w: &DMatrix<f64>, y: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let inverse = w.clone().pseudo_inverse(1e-14).unwrap();
    ((&inverse * y).column(0).into_owned(), &inverse * inverse.transpose())
}

/// Difference of two parameter vectors in standard deviations, and of their covariances in those of the second.
fn differences(fit: &LeastSquares, (beta, covariance): &(DVector<f64>, DMatrix<f64>)) -> (f64, f64) {
    let std: Vec<f64> = covariance.diagonal().iter().map(|v| v.sqrt()).collect();
    let found = fit.inverse_information();
    let (mut of_beta, mut of_covariance) = (0.0_f64, 0.0_f64);
    for i in 0..std.len() {
        of_beta = of_beta.max(((fit.solution()[i] - beta[i]) / std[i]).abs());
        for j in 0..std.len() {
            of_covariance = of_covariance.max(((found[(i, j)] - covariance[(i, j)]) / (std[i] * std[j])).abs());
        }
    }
    (of_beta, of_covariance)
}

#[test]
fn identity_few_samples_hold_what_all_rows_do() {
    let (observation, covariance) = a460(1500);
    let equations = Factorisation::new(&observation).unwrap();
    assert!(equations.samples() < observation.samples(), "{}", equations.samples());
    let y = DMatrix::from_column_slice(observation.y.len(), 1, observation.y.as_slice());
    let ordinary = equations.least_squares().unwrap();
    let (of_beta, of_covariance) = differences(ordinary, &by_decomposition(&observation.regressor, &y));
    // Both routes lose the condition number, some 1e3 here, of 1e-16 of numbers of a thousand standard deviations.
    assert!(of_beta < 1e-9 && of_covariance < 1e-9, "{of_beta:e} {of_covariance:e}");
    let weights = BlockWhitening::new(&covariance).unwrap();
    let weighted = equations.weighted(&weights).unwrap();
    let expected = by_decomposition(
        &marked_rows(&observation, &observation.regressor, &weights),
        &marked_rows(&observation, &y, &weights),
    );
    let (of_beta, of_covariance) = differences(&weighted, &expected);
    assert!(of_beta < 1e-8 && of_covariance < 1e-8, "{of_beta:e} {of_covariance:e}");

    let residual = observation.residual(ordinary.solution());
    let mut products = DMatrix::zeros(6, 6);
    for r in residual.as_slice().chunks_exact(6) {
        products += DMatrix::from_fn(6, 6, |i, j| r[i] * r[j]);
    }
    let found = equations.residual_products(ordinary.solution());
    for i in 0..6 {
        for j in 0..6 {
            let size = (products[(i, i)] * products[(j, j)]).sqrt();
            assert!((found[(i, j)] - products[(i, j)]).abs() < 1e-10 * size, "{i} {j}");
        }
    }
    let seen = equations.residual_covariance(ordinary.solution());
    assert!((&seen - residual_noise(&observation, &residual).covariance()).norm() < 1e-10 * seen.norm());
}

#[test]
fn identity_neither_thread_nor_repetition_changes_a_bit_and_another_observation_is_not_taken_for_this() {
    let (observation, _) = a460(800);
    let equations = Factorisation::new(&observation).unwrap();
    let (robot, nominal, regressor, _, mut samples) = a460_samples(800);
    let guess = nominal.clone();
    let stiff = StiffLoop::new(&robot, regressor.columns(), &nominal, guess, samples.states.clone(), 1e-6);
    for (k, q) in samples.states.q.iter_mut().enumerate() {
        *q += 1e-9 * libm::sin(17.0 * k as f64);
    }
    let problem = EstimationProblem {
        nominal: Some(&nominal),
        robot: Some(&robot),
        samples: Some(&samples),
        closed_loop: Ok(&stiff),
        ..EstimationProblem::new(&observation)
    };
    let shared = EstimationProblem { factorisation: Some(&equations), ..problem };
    for kind in EstimatorKind::ALL {
        let (own, other) = (kind.estimator().estimate(&problem).unwrap(), kind.estimator().estimate(&shared).unwrap());
        assert_eq!(own, other);
    }
    // The factorisation is of the observation that it was made of, whatever a problem says.
    let mut doubled = observation.clone();
    doubled.y *= 2.0;
    let mistaken = EstimationProblem { observation: &doubled, ..shared };
    let own = EstimationProblem { nominal: Some(&nominal), ..EstimationProblem::new(&doubled) };
    let expected = EstimatorKind::Ols.estimator().estimate(&own).unwrap();
    assert_eq!(EstimatorKind::Ols.estimator().estimate(&mistaken).unwrap(), expected);
}

#[test]
fn analytic_an_ill_conditioned_recording_keeps_the_digits_that_normal_equations_lose() {
    let mut rng = Seed::new(52).stream("ill conditioned", 0);
    let (mut observation, _) = synthetic(400, 6, &mut rng);
    let small: DVector<f64> = observation.regressor.column(5) * 1e-8;
    let near = observation.regressor.column(4) + small;
    observation.regressor.set_column(5, &near);
    let beta = DVector::from_vec(vec![1.0, -2.0, 0.5, 3.0, 1.5, -0.7]);
    observation.y = &observation.regressor * &beta;
    let equations = Factorisation::new(&observation).unwrap();
    assert!(equations.samples() < 100);
    assert_eq!(equations.factorised_by, FactorisedBy::Qr);
    for fit in [
        equations.least_squares().unwrap().clone(),
        equations.weighted(&BlockWhitening::new(&nalgebra::dmatrix![0.04, 0.012; 0.012, 0.01]).unwrap()).unwrap(),
    ] {
        // 1e8 of 1e-16; the normal equations would lose 1e16.
        assert!((fit.solution() - &beta).amax() < 1e-6, "{:e}", (fit.solution() - &beta).amax());
        assert!(fit.condition_scaled() > 1e8);
    }
    // With a thousandth of noise too: the condition number alone forbids products.
    observation.y.iter_mut().for_each(|y| *y += 1e-3 * rng.random_range(-1.0..1.0));
    assert_eq!(Factorisation::new(&observation).unwrap().factorised_by, FactorisedBy::Qr);
}

#[test]
fn identity_products_move_no_estimate_by_more_than_was_bounded() {
    // Noise from that of sensors down to none: the less there is, the more rounding counts.
    let (robot, _, regressor, base, samples) = a460_samples(3500);
    let exact = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let inverse = exact.regressor.clone().pseudo_inverse(1e-14).unwrap();
    let mut by = Vec::new();
    for size in [1.0, 0.1, 1e-3, 1e-6, 0.0] {
        let (mut observation, mut rng) = (exact.clone(), Seed::new(54).stream("noise", 0));
        observation.y.iter_mut().for_each(|y| *y += size * rng.random_range(-1.0..1.0));
        let equations = Factorisation::new(&observation).unwrap();
        by.push(equations.factorised_by);
        if equations.factorised_by == FactorisedBy::NormalEquations {
            let (ordinary, beta) = (equations.least_squares().unwrap(), &inverse * &observation.y);
            let residual = observation.residual(ordinary.solution());
            let found = equations.residual_products(ordinary.solution());
            assert!((found.trace() / residual.norm_squared() - 1.0).abs() < 1e-4, "noise {size}");
            // The noise is as large on every joint.
            let std = size / 3.0_f64.sqrt();
            for (j, row) in inverse.row_iter().enumerate() {
                let moved = (ordinary.solution()[j] - beta[j]).abs() / (std * row.norm());
                assert!(moved < 1e-4, "noise {size}, parameter {j}: {moved:e}");
            }
        }
    }
    assert_eq!((by[0], by[4]), (FactorisedBy::NormalEquations, FactorisedBy::Qr));
    assert!(by.is_sorted_by_key(|by| *by == FactorisedBy::Qr), "{by:?}");
}

fn inferred(
    observation: &Observation,
    fit: &LeastSquares,
    instruments: Instruments<'_>,
    noise: &NoiseModel,
) -> Estimate {
    let problem = EstimationProblem::new(observation);
    let basis = IntervalBasis::Scatter;
    let inference = Inference {
        estimator: "test",
        problem: &problem,
        fit,
        instruments,
        noise,
        basis,
        termination: Termination::Direct,
    };
    inference.estimate().unwrap()
}

/// Which findings there are, of which parameter or joint.
fn kinds(estimate: &Estimate) -> Vec<String> {
    let key = |finding: &Finding| match finding {
        Finding::PoorlyDetermined { parameter, .. } => format!("determined {parameter}"),
        Finding::ResidualAboveNoise { joint, .. } => format!("residual {joint}"),
        other => format!("{:?}", std::mem::discriminant(other)),
    };
    estimate.findings.iter().map(key).collect()
}

#[test]
fn identity_instruments_by_weights_are_those_by_rows() {
    let (observation, covariance) = a460(700);
    let equations = Factorisation::new(&observation).unwrap();
    let weights = BlockWhitening::new(&covariance).unwrap();
    let rows = weights.clone().precision(&observation.regressor, &observation.used).unwrap();
    let lags = |l: usize| &covariance * [1.0, 0.5, 0.2].get(l).copied().unwrap_or(0.0);
    for noise in [NoiseModel::white(covariance.clone(), true, 1e6), NoiseModel::adaptive(lags, 50, true, 1e6)] {
        let ordinary = equations.least_squares().unwrap().clone();
        let weighted = equations.weighted(&weights).unwrap();
        for (fit, known, other) in [
            (ordinary, Instruments::Regressor, &observation.regressor),
            (weighted, Instruments::Weighted(&weights), &rows),
        ] {
            let known = inferred(&observation, &fit, known, &noise);
            let other = inferred(&observation, &fit, Instruments::Rows(other), &noise);
            assert_eq!((kinds(&known), known.beta()), (kinds(&other), other.beta()));
            for (a, b) in known.base.iter().zip(&other.base) {
                assert!((a.std / b.std - 1.0).abs() < 1e-9, "{}: {} {}", a.name, a.std, b.std);
            }
        }
    }
}

#[test]
fn faults_of_the_equations_are_named() {
    let (observation, _) = synthetic(60, 4, &mut Seed::new(53).stream("faults", 0));
    let mut bad = observation.clone();
    bad.regressor[(17, 2)] = f64::INFINITY;
    let found = Factorisation::new(&bad).map(|_| ()).unwrap_err();
    let expected = LeastSquaresError::NotFinite { row: 17, value: f64::INFINITY };
    assert_eq!(found, EstimationError::LeastSquares(expected));
    let mut short = observation.clone();
    short.used.pop();
    let expected = LeastSquaresError::Shape { found: 119, expected: 120 };
    assert_eq!(Factorisation::new(&short).map(|_| ()).unwrap_err(), EstimationError::LeastSquares(expected));
    let mut flat = observation;
    let twice = flat.regressor.column(0) * 2.0;
    flat.regressor.set_column(3, &twice);
    let equations = Factorisation::new(&flat).unwrap();
    assert!(matches!(equations.least_squares(), Err(EstimationError::NotExcited { .. })));
}
