//! The central difference Kalman filter: Stirling's interpolation in place of derivatives.
//!
//! ```text
//! Z±_i = H (γ ± √3 S_i)        ẑ = (3 − b)/3 Z_0 + Σ (Z+_i + Z−_i)/6
//! P_zz = Σ (Z+_i − Z−_i)(…)ᵀ/12 + Σ (Z+_i + Z−_i − 2 Z_0)(…)ᵀ/18 + 1        P_γz = Σ S_i (Z+_i − Z−_i)ᵀ/(2√3)
//! ```
//! For a linear measurement second differences vanish.
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails as
//! `ukf`: each sample takes a Cholesky factor of P, which poor conditioning makes indefinite, and differences of points only find
//! again the H that is known.
//!
//! Source: M. Nørgaard, N. K. Poulsen, O. Ravn, "New developments in state estimation for nonlinear systems", Automatica
//! 36(11), 2000.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::sigma::SigmaPoints;
use super::walk;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator};

/// The central difference Kalman filter by covariances.
#[derive(Clone, Copy, Debug, Default)]
pub struct CentralDifferenceKalmanFilter;

impl Estimator for CentralDifferenceKalmanFilter {
    fn name(&self) -> &'static str {
        "cdkf"
    }

    fn summary(&self) -> &'static str {
        "central difference Kalman filter of parameters that walk at random"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        walk::estimate::<CentralDifference>(self.name(), problem)
    }
}

/// Mean and covariance.
pub(super) struct CentralDifference {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Belief for CentralDifference {
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
        let reach = 3.0_f64.sqrt();
        let points = SigmaPoints::of(h, &self.mean, &root, reach);
        let expected = points.mean((3.0 - b as f64) / 3.0, 1.0 / 6.0);
        let first = (&points.plus - &points.minus) / (2.0 * reach);
        let second = DMatrix::from_fn(m, b, |i, j| {
            (points.plus[(i, j)] + points.minus[(i, j)] - 2.0 * points.centre[i]) / 18.0_f64.sqrt()
        });
        let innovation = &first * first.transpose() + &second * second.transpose() + DMatrix::identity(m, m);
        let cross = &root * first.transpose();
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
