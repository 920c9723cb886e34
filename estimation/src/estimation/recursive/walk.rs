//! The random walk that all filters share, in units in which no unit matters.
//!
//! ```text
//! γ_j = β_j √A_jj, A = WᵀΣ⁻¹W        γ_0, P_0 by least squares of the first quarter        Q = 0.01 min_j var γ_j / M · 1
//! ```
//! A prior that says nothing would cost all digits where covariances are carried, so a filter begins where a part of the recording
//! determines every parameter: its first quarter, half, or all of it. Over the recording the walk adds a hundredth of
//! the smallest variance that weighted least squares would have: hardly anything, but enough to keep the gain
//! above zero.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::inference::solve;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::estimation::unit_equations::UnitEquations;
use crate::linalg::LeastSquares;

/// Parts of the recording that a filter may begin with.
const FIRST: [usize; 3] = [4, 2, 1];

/// Condition number with unit columns up to which covariances keep half of their digits.
const WELL_CONDITIONED: f64 = 1e4;

/// Variance that the walk adds over the recording, as a part of the least variance of γ.
const WALK: f64 = 1e-2;

/// The estimate of a filter.
pub(super) fn estimate<B: Belief>(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    let observation = problem.observation;
    let linear = LinearFit::weighted(&*problem.factorised()?)?;
    let UnitEquations { h, z, scale } = UnitEquations::of(observation, &linear)?;
    let b = h.ncols();
    let samples = observation.samples();
    let (first, start) = beginning(observation, &h, &z)?;
    let inverse = linear.fit.inverse_information();
    let least = (0..b).map(|j| inverse[(j, j)] / (scale[j] * scale[j])).fold(f64::INFINITY, f64::min);
    let step = WALK * least / samples as f64;
    let prior = start.inverse_information();
    let mut belief = B::prior(start.solution().clone(), prior).ok_or(EstimationError::NotDefinite)?;
    let mut termination = Termination::Direct;
    for k in first..samples {
        let rows: Vec<usize> =
            (k * observation.dof..(k + 1) * observation.dof).filter(|&row| observation.used[row]).collect();
        if let Some(interrupted) = problem.ended_after(k, samples) {
            termination = interrupted;
            break;
        }
        belief.walk(step);
        if rows.is_empty() {
            continue;
        }
        if !belief.update(&h.select_rows(&rows), &z.select_rows(&rows)) {
            termination = Termination::Singular { iterations: k };
            break;
        }
    }
    // The filter's own covariance stands for (WᵀΣ⁻¹W)⁻¹: β̂ = P Σ_k W_kᵀ Σ⁻¹ y_k but for what walked.
    let own = belief.covariance();
    let inverse = DMatrix::from_fn(b, b, |i, j| own[(i, j)] * scale[i] * scale[j]);
    let fit = linear.fit.with_solution(belief.mean().component_mul(&scale), inverse)?;
    let estimate = linear.estimate(name, problem, &fit, termination)?;
    // What walked since a sample is not in the sandwich of its noise.
    let walked = step * samples as f64;
    let covariance = estimate.covariance_matrix() + DMatrix::from_diagonal(&scale.map(|s| s * s * walked));
    Ok(estimate.with_covariance(&covariance))
}

/// The first samples that determine every parameter, how many they are, and what they say.
fn beginning(
    observation: &Observation,
    h: &DMatrix<f64>,
    z: &DVector<f64>,
) -> Result<(usize, LeastSquares), EstimationError> {
    let mut last = Err(EstimationError::NotDefinite);
    for part in FIRST {
        let first = observation.samples() / part;
        let rows = first * observation.dof;
        last = solve(observation, &h.rows(0, rows).into_owned(), &z.rows(0, rows).into_owned()).map(|fit| (first, fit));
        if last.as_ref().is_ok_and(|(_, fit)| fit.condition_scaled() <= WELL_CONDITIONED) {
            break;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::super::{ekf, pf};
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    fn filtered<B: Belief>(samples: &[(DMatrix<f64>, DVector<f64>)]) -> (DVector<f64>, DMatrix<f64>) {
        let mut belief = B::prior(DVector::zeros(4), DMatrix::identity(4, 4) * 100.0).unwrap();
        for (h, z) in samples {
            belief.walk(1e-3);
            assert!(belief.update(h, z));
        }
        (belief.mean().clone(), belief.covariance())
    }

    #[test]
    fn identity_both_filters_have_the_posterior_of_the_information_form() {
        let mut rng = Seed::new(99).stream("filters", 0);
        let truth = DVector::from_vec(vec![1.0, -2.0, 0.5, 3.0]);
        let samples: Vec<_> = (0..50)
            .map(|_| {
                let h = DMatrix::from_fn(2, 4, |_, _| rng.random_range(-1.0..1.0));
                let z = &h * &truth + DVector::from_fn(2, |_, _| rng.random_range(-1.7..1.7));
                (h, z)
            })
            .collect();
        // Information form, another route: Λ ← (Λ⁻¹ + Q)⁻¹ + HᵀH.
        let (mut information, mut mean) = (DMatrix::<f64>::identity(4, 4) / 100.0, DVector::zeros(4));
        for (h, z) in &samples {
            let walked = information.try_inverse().unwrap() + DMatrix::identity(4, 4) * 1e-3;
            let before = walked.try_inverse().unwrap();
            information = &before + h.tr_mul(h);
            mean = information.clone().try_inverse().unwrap() * (&before * mean + h.tr_mul(z));
        }
        let covariance = information.try_inverse().unwrap();
        let (found, spread) = filtered::<ekf::Covariance>(&samples);
        assert!((&found - &mean).norm() < 1e-9, "{found} {mean}");
        assert!((&spread - &covariance).norm() < 1e-9 * covariance.norm());
        // Random points have it but for what they miss.
        let (found, spread) = filtered::<pf::Particles>(&samples);
        let apart = (&found - &mean).component_div(&covariance.diagonal().map(f64::sqrt)).norm() / 2.0;
        let wide = (&spread - &covariance).norm() / covariance.norm();
        assert!(apart < 0.1 && wide < 0.15, "{apart} {wide}");
    }

    #[test]
    fn published_steps_are_those_of_filterpy() {
        // filterpy 2.0.0, KalmanFilter and UnscentedKalmanFilter (alike to 1e-12) of two constants: F = 1, Q = 1e-3,
        // P0 = 100, R = 1, three samples of one row.
        let samples: Vec<_> = [([1.0, 0.5], 2.1), ([0.3, -1.0], -0.4), ([-0.7, 0.9], 0.2)]
            .into_iter()
            .map(|(h, z)| (DMatrix::from_row_slice(1, 2, &h), DVector::from_vec(vec![z])))
            .collect();
        let mut belief = ekf::Covariance::prior(DVector::zeros(2), DMatrix::identity(2, 2) * 100.0).unwrap();
        for (h, z) in &samples {
            belief.walk(1e-3);
            assert!(belief.update(h, z));
        }
        let spread = belief.covariance();
        for (found, expected) in belief.mean().iter().chain(spread.iter()).zip(FILTERPY) {
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
    }

    const FILTERPY: [f64; 6] = [
        1.451_603_282_714_454_7,
        1.089_067_067_332_617_3,
        0.667_726_630_640_675_3,
        0.139_193_039_610_324_7,
        0.139_193_039_610_324_7,
        0.512_561_283_824_540_1,
    ];
}
