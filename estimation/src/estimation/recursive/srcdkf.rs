//! The central difference Kalman filter by square roots.
//!
//! ```text
//! S_z = root of [(Z+_i − Z−_i)/(2√3), (Z+_i + Z−_i − 2 Z_0)/√18, 1]        U = P_γz S_z⁻ᵀ        S ← root of S Sᵀ − U Uᵀ
//! ```
//! Points as for `cdkf`.
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails as
//! `srukf`, where rounding leaves S Sᵀ − U Uᵀ indefinite, and by wrong samples and noisy states as `wls`.
//!
//! Source: R. van der Merwe, *Sigma-Point Kalman Filters for Probabilistic Inference in Dynamic State-Space Models*, thesis,
//! OHSU, 2004, section 3.3.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::sigma::SigmaPoints;
use super::square_root::{downdated, root_of, walked};
use super::walk;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator};

/// The central difference Kalman filter by square roots.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquareRootCentralDifferenceKalmanFilter;

impl Estimator for SquareRootCentralDifferenceKalmanFilter {
    fn name(&self) -> &'static str {
        "srcdkf"
    }

    fn summary(&self) -> &'static str {
        "central difference Kalman filter by square roots of covariances"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        walk::estimate::<CentralDifferenceRoot>(self.name(), problem)
    }
}

/// Mean and root of the covariance.
pub(super) struct CentralDifferenceRoot {
    mean: DVector<f64>,
    root: DMatrix<f64>,
}

impl Belief for CentralDifferenceRoot {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self { mean, root: covariance.cholesky()?.l() })
    }

    fn walk(&mut self, variance: f64) {
        self.root = walked(&self.root, variance);
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let (m, b) = h.shape();
        let reach = 3.0_f64.sqrt();
        let points = SigmaPoints::of(h, &self.mean, &self.root, reach);
        let expected = points.mean((3.0 - b as f64) / 3.0, 1.0 / 6.0);
        let first = (&points.plus - &points.minus) / (2.0 * reach);
        let array = DMatrix::from_fn(m, 2 * b + m, |i, j| {
            if j < b {
                first[(i, j)]
            } else if j < 2 * b {
                (points.plus[(i, j - b)] + points.minus[(i, j - b)] - 2.0 * points.centre[i]) / 18.0_f64.sqrt()
            } else {
                f64::from(u8::from(j - 2 * b == i))
            }
        });
        let innovation = root_of(&array);
        let cross = &self.root * first.transpose();
        let Some(spread) = innovation.solve_lower_triangular(&cross.transpose()) else { return false };
        let Some(white) = innovation.solve_lower_triangular(&(z - expected)) else { return false };
        self.mean += spread.tr_mul(&white);
        for u in spread.row_iter() {
            let Some(less) = downdated(self.root.clone(), u.transpose()) else { return false };
            self.root = less;
        }
        true
    }

    fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    fn covariance(&self) -> DMatrix<f64> {
        &self.root * self.root.transpose()
    }
}
