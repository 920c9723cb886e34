//! The (extended) Kalman filter of the parameters, by covariances.
//!
//! ```text
//! K = P Hᵀ (H P Hᵀ + 1)⁻¹        γ ← γ + K (z − H γ)        P ← (1 − K H) P (1 − K H)ᵀ + K Kᵀ
//! ```
//! The measurement is linear, so that the extension linearises nothing. Joseph's form keeps P positive definite but for
//! rounding.
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails
//! where columns of unit length have a condition number far above 1e4: P carries its square, and where P ceases to be definite the
//! filter ends there and says so. A wrong sample moves all that follow it, as it moves `wls`.
//!
//! Source: R. E. Kalman, "A new approach to linear filtering and prediction problems", Journal of Basic Engineering 82(1), 1960.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::walk;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;

/// The Kalman filter by covariances.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    walk::estimate::<Covariance>(name, problem)
}

/// Mean and covariance.
pub(super) struct Covariance {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Belief for Covariance {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self { mean, covariance })
    }

    fn walk(&mut self, variance: f64) {
        for j in 0..self.mean.len() {
            self.covariance[(j, j)] += variance;
        }
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let cross = &self.covariance * h.transpose();
        let innovation = h * &cross + DMatrix::identity(z.len(), z.len());
        let Some(factor) = ((&innovation + innovation.transpose()) * 0.5).cholesky() else { return false };
        let gain = factor.solve(&cross.transpose()).transpose();
        self.mean += &gain * (z - h * &self.mean);
        let b = self.mean.len();
        let left = DMatrix::identity(b, b) - &gain * h;
        let joseph = &left * &self.covariance * left.transpose() + &gain * gain.transpose();
        self.covariance = (&joseph + joseph.transpose()) * 0.5;
        true
    }

    fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    fn covariance(&self) -> DMatrix<f64> {
        self.covariance.clone()
    }
}
