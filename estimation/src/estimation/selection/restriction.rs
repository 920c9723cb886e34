//! What it means for the base parameters that a term is absent, and whether they contradict it.
//!
//! ```text
//! β = K φ,  φ_T = 0:   β in the range of A = columns of K of the other parameters        L A = 0        L β = 0, r equations
//! W = (L β̂)ᵀ (L V Lᵀ)⁻¹ L β̂        F = W/r  with r and ν degrees of freedom
//! β̃ = β̂ − V Lᵀ (L V Lᵀ)⁻¹ L β̂
//! ```
//! V is the covariance of β̂, known to ν degrees of freedom: for one joint and white noise F is the classical ratio of sums of
//! squares. With V of the equations' own weights, β̃ is their solution without the term.

use nalgebra::{DMatrix, DVector, SVD};

use crate::base::BaseReduction;
use crate::estimation::consistent_set::definite_inverse;
use crate::statistics::f_tail;

use super::evidence::FTest;

/// Singular values below this part of the largest are zero, in units of the standard deviations.
const ZERO: f64 = 1e-9;

/// `L β = 0`.
#[derive(Clone, Debug)]
pub(super) struct Restriction {
    /// L, r × b.
    rows: DMatrix<f64>,
}

impl Restriction {
    /// That the parameters for which `is_term` are zero. `std` (b) gives the units.
    pub(super) fn of(base: &BaseReduction, is_term: impl Fn(usize) -> bool, std: &DVector<f64>) -> Self {
        let others: Vec<usize> = (0..base.parameters.len()).filter(|&c| !is_term(c)).collect();
        let b = base.rank();
        // As many columns as rows at least, so that all left vectors are found.
        let a =
            DMatrix::from_fn(b, others.len().max(b), |i, c| others.get(c).map_or(0.0, |&c| base.k[(i, c)] / std[i]));
        let size = a.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let svd = SVD::new(a / if size > 0.0 { size } else { 1.0 }, true, false);
        let largest = svd.singular_values.max();
        let left: Vec<DVector<f64>> = svd
            .u
            .iter()
            .flat_map(|u| u.column_iter())
            .zip(svd.singular_values.iter())
            .filter(|&(_, &value)| value <= ZERO * largest)
            .map(|(column, _)| column.component_div(std))
            .collect();
        let rows = if left.is_empty() { DMatrix::zeros(0, b) } else { DMatrix::from_columns(&left).transpose() };
        Self { rows }
    }

    /// Number of equations r.
    pub(super) fn len(&self) -> usize {
        self.rows.nrows()
    }

    /// W; `None` where V is not positive definite.
    pub(super) fn wald(&self, beta: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<f64> {
        let value = &self.rows * beta;
        let information = definite_inverse(&(&self.rows * covariance * self.rows.transpose()))?;
        Some(value.dot(&(information * &value)))
    }

    /// β̃; `None` where V is not positive definite.
    pub(super) fn restricted(&self, beta: &DVector<f64>, inverse: &DMatrix<f64>) -> Option<DVector<f64>> {
        let gain = inverse * self.rows.transpose();
        let information = definite_inverse(&(&self.rows * &gain))?;
        Some(beta - gain * (information * (&self.rows * beta)))
    }

    /// The test of W, whose V is known to `freedom`.
    pub(super) fn test(&self, wald: f64, freedom: f64) -> FTest {
        let r = self.len() as f64;
        FTest { value: wald / r, freedom: [r, freedom], p_value: f_tail(wald / r, r, freedom) }
    }
}
