//! The unscented Kalman filter by square roots.
//!
//! ```text
//! S_z = root of [√w (Z_i − ẑ), 1]        U = P_γz S_z⁻ᵀ        S ← root of S Sᵀ − U Uᵀ, column after column
//! ```
//! Points and weights as for `ukf`.
//!
//! Assumes what `wls` does, and parameters that stand still or drift more slowly than the walk ([`super::walk`]) allows. Fails
//! where rounding leaves S Sᵀ − U Uᵀ indefinite: the filter ends at that sample and says so. Wrong samples and noisy states bias it
//! as they do `wls`.
//!
//! Source: R. van der Merwe, E. A. Wan, "The square-root unscented Kalman filter for state and parameter-estimation",
//! Proc. IEEE ICASSP, 2001.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;
use super::sigma::SigmaPoints;
use super::square_root::{downdated, root_of, walked};
use super::walk;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, Estimator};

/// The unscented Kalman filter by square roots.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquareRootUnscentedKalmanFilter;

impl Estimator for SquareRootUnscentedKalmanFilter {
    fn name(&self) -> &'static str {
        "srukf"
    }

    fn summary(&self) -> &'static str {
        "unscented Kalman filter by square roots of covariances"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        walk::estimate::<UnscentedRoot>(self.name(), problem)
    }
}

/// Mean and root of the covariance.
pub(super) struct UnscentedRoot {
    mean: DVector<f64>,
    root: DMatrix<f64>,
}

impl Belief for UnscentedRoot {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self { mean, root: covariance.cholesky()?.l() })
    }

    fn walk(&mut self, variance: f64) {
        self.root = walked(&self.root, variance);
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let (m, b) = h.shape();
        let reach = (b as f64).sqrt();
        let points = SigmaPoints::of(h, &self.mean, &self.root, reach);
        let weight = 0.5 / b as f64;
        let expected = points.mean(0.0, weight);
        let mut array = DMatrix::zeros(m, 2 * b + m);
        let mut cross = DMatrix::zeros(b, m);
        for j in 0..b {
            for (side, all, at) in [(1.0, &points.plus, j), (-1.0, &points.minus, b + j)] {
                let apart = all.column(j) - &expected;
                array.set_column(at, &(&apart * weight.sqrt()));
                cross += self.root.column(j) * apart.transpose() * (side * reach * weight);
            }
        }
        array.view_mut((0, 2 * b), (m, m)).fill_with_identity();
        let innovation = root_of(&array);
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
