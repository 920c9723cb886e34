//! The Kalman filter with a square root of the covariance, whose condition number is the square root of the
//! covariance's: half as many digits are lost.
//!
//! ```text
//! [ 1  H S ]       [ S_z    0 ]
//! [ 0   S  ] Θ  =  [ K S_z  S']        Θ orthogonal, P = S Sᵀ        γ ← γ + K S_z S_z⁻¹ (z − H γ)
//! ```
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails as
//! `wls` by wrong samples and noisy states; by rounding at the square of the condition number at which `ekf` does.
//!
//! Source: P. Kaminski, A. Bryson, S. Schmidt, "Discrete square root filtering: a survey of current techniques", IEEE
//! Trans. Automatic Control 16(6), 1971.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::square_root::{root_of, walked};
use super::walk;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator};

/// The Kalman filter by one orthogonal transformation for each sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquareRootExtendedKalmanFilter;

impl Estimator for SquareRootExtendedKalmanFilter {
    fn name(&self) -> &'static str {
        "srekf"
    }

    fn summary(&self) -> &'static str {
        "Kalman filter by square roots of covariances"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        walk::estimate::<Root>(self.name(), problem)
    }
}

/// Mean and root of the covariance.
pub(super) struct Root {
    mean: DVector<f64>,
    root: DMatrix<f64>,
}

impl Belief for Root {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self { mean, root: covariance.cholesky()?.l() })
    }

    fn walk(&mut self, variance: f64) {
        self.root = walked(&self.root, variance);
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let (m, b) = h.shape();
        let seen = h * &self.root;
        let mut array = DMatrix::identity(m + b, m + b);
        array.view_mut((0, m), (m, b)).copy_from(&seen);
        array.view_mut((m, m), (b, b)).copy_from(&self.root);
        let lower = root_of(&array);
        let innovation = lower.view((0, 0), (m, m)).into_owned();
        let Some(white) = innovation.solve_lower_triangular(&(z - h * &self.mean)) else { return false };
        self.mean += lower.view((m, 0), (b, m)) * white;
        self.root = lower.view((m, m), (b, b)).into_owned();
        true
    }

    fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    fn covariance(&self) -> DMatrix<f64> {
        &self.root * self.root.transpose()
    }
}
