//! The unscented Kalman filter: means and covariances from points.
//!
//! ```text
//! χ_i = γ, γ ± √b S_i, weights 0 and 1/(2b)        ẑ = Σ w Z_i        P_zz = Σ w (Z_i − ẑ)(…)ᵀ + 1        P_γz = Σ w (χ_i − γ)(Z_i − ẑ)ᵀ
//! ```
//! α = 1, κ = 0: no weight is negative. For a linear measurement the points give its mean and covariance exactly.
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails as
//! `ekf` by poor conditioning, since each sample takes a Cholesky factor of P, and costs 2b + 1 evaluations for what one gives:
//! points repay where a measurement is not linear, and this one is.
//!
//! Source: S. J. Julier, J. K. Uhlmann, "Unscented filtering and nonlinear estimation", Proceedings of the IEEE 92(3), 2004.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::sigma::SigmaPoints;
use super::walk;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator};

/// The unscented Kalman filter by covariances.
#[derive(Clone, Copy, Debug, Default)]
pub struct UnscentedKalmanFilter;

impl Estimator for UnscentedKalmanFilter {
    fn name(&self) -> &'static str {
        "ukf"
    }

    fn summary(&self) -> &'static str {
        "unscented Kalman filter of parameters that walk at random"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        walk::estimate::<Unscented>(self.name(), problem)
    }
}

/// Mean and covariance.
pub(super) struct Unscented {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Belief for Unscented {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self { mean, covariance })
    }

    fn walk(&mut self, variance: f64) {
        for j in 0..self.mean.len() {
            self.covariance[(j, j)] += variance;
        }
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let Some(root) = self.covariance.clone().cholesky().map(|factor| factor.l()) else { return false };
        let (m, b) = h.shape();
        let reach = (b as f64).sqrt();
        let points = SigmaPoints::of(h, &self.mean, &root, reach);
        let weight = 0.5 / b as f64;
        let expected = points.mean(0.0, weight);
        let (mut innovation, mut cross) = (DMatrix::identity(m, m), DMatrix::zeros(b, m));
        for j in 0..b {
            for (side, all) in [(1.0, &points.plus), (-1.0, &points.minus)] {
                let apart = all.column(j) - &expected;
                innovation += &apart * apart.transpose() * weight;
                cross += root.column(j) * apart.transpose() * (side * reach * weight);
            }
        }
        let Some(factor) = innovation.clone().cholesky() else { return false };
        let gain = factor.solve(&cross.transpose()).transpose();
        self.mean += &gain * (z - expected);
        let less = &self.covariance - &gain * innovation * gain.transpose();
        self.covariance = (&less + less.transpose()) * 0.5;
        true
    }

    fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    fn covariance(&self) -> DMatrix<f64> {
        self.covariance.clone()
    }
}
