//! How often 95 % intervals hold the truth.
//!
//! The bounds are the project's: pooled over parameters 93-97 %, each parameter 90.4-98.6 %. With 1000 runs a single
//! parameter's count has a standard deviation of 0.7 %, so a correct interval leaves its band with a probability below
//! 1e-6 (6 standard deviations below, 5 above).

use nalgebra::{DMatrix, DVector, dmatrix};

use super::setting::{a460_samples, synthetic, white};
use crate::estimation::{Estimate, EstimationProblem, EstimatorKind, Finding, IntervalBasis, Observation};
use crate::linalg::LeastSquares;
use crate::seed::Seed;
use crate::signal::NoiseModel;

/// Counts per parameter over many runs.
pub(super) struct Coverage {
    held: Vec<usize>,
    runs: usize,
}

impl Coverage {
    pub(super) fn new(b: usize) -> Self {
        Self { held: vec![0; b], runs: 0 }
    }

    pub(super) fn add(&mut self, estimate: &Estimate, beta: &DVector<f64>) {
        self.runs += 1;
        for (held, (p, truth)) in self.held.iter_mut().zip(estimate.base.iter().zip(beta.iter())) {
            *held += usize::from(p.ci95[0] <= *truth && *truth <= p.ci95[1]);
        }
    }

    pub(super) fn pooled(&self) -> f64 {
        self.held.iter().sum::<usize>() as f64 / (self.runs * self.held.len()) as f64
    }

    pub(super) fn check(&self) {
        assert!(self.runs >= 500);
        assert!((0.93..=0.97).contains(&self.pooled()), "pooled {}", self.pooled());
        for (j, &held) in self.held.iter().enumerate() {
            let share = held as f64 / self.runs as f64;
            assert!((0.904..=0.986).contains(&share), "parameter {j}: {share}");
        }
    }
}

fn covariance() -> DMatrix<f64> {
    dmatrix![0.04, 0.012; 0.012, 0.01]
}

#[test]
fn analytic_coverage_with_the_covariance_known() {
    let seed = Seed::new(21);
    let (exact, beta) = synthetic(60, 8, &mut seed.stream("regressor", 0));
    for kind in [EstimatorKind::Ols, EstimatorKind::Wls] {
        let mut coverage = Coverage::new(8);
        for run in 0..1000 {
            let mut observation = exact.clone();
            observation.y += white(&covariance(), 60, &mut seed.stream("noise", run));
            observation.noise = Some(NoiseModel::white(covariance(), false, 1e9));
            observation.periods = 10;
            let estimate = kind.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
            assert_eq!(estimate.interval_basis, IntervalBasis::Scatter);
            coverage.add(&estimate, &beta);
        }
        coverage.check();
    }
}

#[test]
fn analytic_coverage_with_the_covariance_from_the_residual() {
    let seed = Seed::new(22);
    let (exact, beta) = synthetic(150, 8, &mut seed.stream("regressor", 0));
    let kinds = [
        EstimatorKind::Ols,
        EstimatorKind::Wls,
        EstimatorKind::IrlsHuber,
        EstimatorKind::IrlsTukey,
        EstimatorKind::IrlsCauchy,
    ];
    for kind in kinds {
        let mut coverage = Coverage::new(8);
        for run in 0..1000 {
            let mut observation = exact.clone();
            observation.y += white(&covariance(), 150, &mut seed.stream("noise", run));
            let estimate = kind.estimator().estimate(&EstimationProblem::new(&observation)).unwrap();
            assert!(estimate.findings.contains(&Finding::NoiseFromResidual));
            coverage.add(&estimate, &beta);
        }
        coverage.check();
    }
}

/// Moving average of white noise over five samples, and its lag covariances `(5 − l)/25 · Σ`.
fn coloured(count: usize, run: u64, seed: Seed) -> DVector<f64> {
    let raw = white(&covariance(), count + 4, &mut seed.stream("noise", run));
    DVector::from_fn(2 * count, |row, _| (0..5).map(|l| raw[row + 2 * l]).sum::<f64>() / 5.0)
}

#[test]
fn analytic_coverage_under_noise_that_is_correlated_in_time() {
    // Smooth columns, as regressors are: neighbouring samples then carry the same information, and error bars that
    // take the noise for white are too short by about √5.
    let seed = Seed::new(23);
    let (count, b) = (400, 6);
    let (mut exact, beta) = synthetic(count, b, &mut seed.stream("regressor", 0));
    for j in 0..b {
        for k in 0..count {
            let phase = std::f64::consts::TAU * ((j + 1) * k) as f64 / count as f64;
            exact.regressor[(2 * k, j)] = libm::sin(phase + j as f64);
            exact.regressor[(2 * k + 1, j)] = libm::cos(phase * 2.0 - j as f64);
        }
    }
    exact.y = &exact.regressor * &beta;
    let run = |run: u64, noise: Option<NoiseModel>| {
        let mut observation = exact.clone();
        observation.y += coloured(count, run, seed);
        observation.noise = noise;
        EstimatorKind::Wls.estimator().estimate(&EstimationProblem::new(&observation)).unwrap()
    };
    let known =
        NoiseModel::adaptive(|l| covariance() * if l < 5 { (5 - l) as f64 / 25.0 } else { 0.0 }, 100, false, 1e9);
    let naive = NoiseModel::white(covariance() / 5.0, false, 1e9);
    let (mut with_lags, mut without, mut residual) = (Coverage::new(b), Coverage::new(b), Coverage::new(b));
    for k in 0..1000 {
        with_lags.add(&run(k, Some(known.clone())), &beta);
        without.add(&run(k, Some(naive.clone())), &beta);
        residual.add(&run(k, None), &beta);
    }
    with_lags.check();
    // P(|z| < 1.96/√5) = 0.62.
    assert!((without.pooled() - 0.62).abs() < 0.03, "white error bars cover {}", without.pooled());
    // Lags seen in one residual of 400 samples are themselves uncertain; they must not be far off.
    assert!(residual.pooled() > 0.88, "from the residual {}", residual.pooled());
}

#[test]
fn analytic_coverage_on_the_a460_with_its_noise() {
    let seed = Seed::new(24);
    let (robot, parameters, regressor, base, samples) = a460_samples(100);
    let exact = Observation::new(&robot, &regressor, &base, &samples).unwrap();
    let beta = base.beta(&parameters.vector(&robot, regressor.columns()));
    // Current noise of the robot file as torque: a diagonal Σ whose entries differ a thousandfold.
    let std: Vec<f64> = robot.joints().iter().map(|j| j.drive.current_noise * j.drive.torque_per_ampere()).collect();
    let covariance = DMatrix::from_diagonal(&DVector::from_iterator(6, std.iter().map(|s| s * s)));
    let mut coverage = Coverage::new(base.rank());
    let (mut ols_spread, mut wls_spread) = (DVector::zeros(base.rank()), DVector::zeros(base.rank()));
    for run in 0..500 {
        let mut observation = exact.clone();
        observation.y += white(&covariance, 100, &mut seed.stream("noise", run));
        observation.noise = Some(NoiseModel::white(covariance.clone(), true, 1e9));
        let problem = EstimationProblem::new(&observation);
        let estimate = EstimatorKind::Wls.estimator().estimate(&problem).unwrap();
        coverage.add(&estimate, &beta);
        if run < 50 {
            // Noise alone is no misfit, although in an ordinary fit the noise of J1-3 leaks into the residual of J4-6.
            let ols = EstimatorKind::Ols.estimator().estimate(&problem).unwrap();
            for e in [&estimate, &ols] {
                assert_eq!(e.interval_basis, IntervalBasis::Scatter, "run {run}, {}: {:?}", e.estimator, e.findings);
            }
        }
        if run == 0 {
            ols_spread = EstimatorKind::Ols.estimator().estimate(&problem).unwrap().std();
            wls_spread = estimate.std();
            // The bound itself, by another route: (WᵀΣ⁻¹W)⁻¹ from rows divided by their own σ.
            let mut w = exact.regressor.clone();
            for (row, mut entries) in w.row_iter_mut().enumerate() {
                entries /= std[row % 6];
            }
            let bound = LeastSquares::solve(&w, &DVector::zeros(600)).unwrap().inverse_information();
            for j in 0..base.rank() {
                assert!((wls_spread[j] / bound[(j, j)].sqrt() - 1.0).abs() < 1e-9);
            }
        }
    }
    // 500 runs: a single parameter's count has a standard deviation of 0.97 %; 58 of them stay inside the band with a
    // probability of 0.998.
    coverage.check();
    // Gauss and Markov: no linear unbiased estimator has a smaller variance.
    for j in 0..base.rank() {
        assert!(wls_spread[j] <= ols_spread[j] * (1.0 + 1e-9));
    }
}
