//! Which combinations of parameters the simulated motion shows, beside what torque says of them.
//!
//! ```text
//! β = β_τ + T z,  T Tᵀ = cov β_τ        Σ^{-½} J T = U S Vᵀ        s_j = std of z_j by torque (1) over that by positions
//! ```
//! An integral in the servo hides every constant torque, and a motion that shows them less than that is as good as blind: a step
//! along such a combination is as long as the noise wants it, and no arm is left to simulate. Combinations with `s_j` below
//! [`LEAST`] keep the value and the covariance that torque gave them; on the A460 those of its six offsets have 1e-7 and less,
//! all others 1 and more.

use nalgebra::{Cholesky, DMatrix, Dyn, SymmetricEigen};

use crate::estimation::error::EstimationError;
use crate::estimation::finding::Finding;
use crate::estimation::observation::Observation;
use crate::linalg::{BlockWhitening, product};

/// Standard deviation by torque over that by positions, below which positions do not count.
const LEAST: f64 = 0.01;

/// Combinations of parameters that keep their value.
pub(super) struct Hidden {
    /// T.
    scale: Cholesky<f64, Dyn>,
    /// Their V, b × h.
    z: DMatrix<f64>,
}

impl Hidden {
    /// At a trial point with slope `jacobian`, for positions of these weights and parameters that torque knows with `covariance`.
    pub(super) fn at(
        jacobian: &DMatrix<f64>,
        observation: &Observation,
        weights: &BlockWhitening,
        covariance: DMatrix<f64>,
    ) -> Result<Self, EstimationError> {
        let scale = Cholesky::new(covariance).ok_or(EstimationError::NotDefinite)?;
        let white = weights.clone().whiten(jacobian, &observation.used)?;
        let scaled = product(&white, &scale.l());
        let eigen = SymmetricEigen::new(product(&scaled.transpose(), &scaled));
        let hidden: Vec<usize> = (0..scaled.ncols()).filter(|&j| eigen.eigenvalues[j] < LEAST * LEAST).collect();
        Ok(Self { scale, z: eigen.eigenvectors.select_columns(&hidden) })
    }

    /// Equations without right side that hold them as firmly as torque does: `Vᵀ T⁻¹ Δ = 0`, h × b.
    pub(super) fn held(&self) -> DMatrix<f64> {
        // Vᵀ T⁻¹ = (T⁻ᵀ V)ᵀ.
        let mut columns = self.z.clone();
        self.scale.l_dirty().tr_solve_lower_triangular_mut(&mut columns);
        columns.transpose()
    }

    /// Their part of the covariance: `T V Vᵀ Tᵀ`.
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let directions = self.directions();
        product(&directions, &directions.transpose())
    }

    /// What is to be said of them, where there are any: the parameters that they move by more than a thousandth of what torque
    /// leaves open; `nominal` where they keep nominal values.
    pub(super) fn finding(&self, observation: &Observation, nominal: bool) -> Option<Finding> {
        let (directions, l, names) = (self.directions(), self.scale.l(), observation.base.names());
        let is_theirs = |j: &usize| 1e3 * directions.row(*j).norm() > l.row(*j).norm();
        let parameters = (0..l.nrows()).filter(is_theirs).map(|j| names[j].clone()).collect();
        let combinations = self.z.ncols();
        (combinations > 0).then_some(Finding::HiddenFromPositions { combinations, parameters, nominal })
    }

    /// T V.
    fn directions(&self) -> DMatrix<f64> {
        product(&self.scale.l(), &self.z)
    }
}
