//! What the equations are multiplied with to find β̂.
//!
//! ```text
//! Bᵀ (y − W β̂) = 0        B = W (OLS), Σ⁻¹ W (WLS), or any other (n·M) × b
//! ```

use std::ops::Range;

use nalgebra::DMatrix;

use super::error::EstimationError;
use super::observation::Observation;
use crate::linalg::BlockWhitening;
use crate::linalg::product::transposed_product;

/// Columns that are worked on at once: an even number, since transforms take two.
pub(super) const COLUMNS: usize = 8;

/// B, by which a linear estimate is `β̂ = A⁻¹ Bᵀ y` to first order in the noise.
#[derive(Clone, Copy, Debug)]
pub enum Instruments<'a> {
    /// The regressor itself.
    Regressor,
    /// The regressor times the inverse covariance of each sample.
    Weighted(&'a BlockWhitening),
    /// Others, (n·M) × b; zero in rows that are no equation.
    Rows(&'a DMatrix<f64>),
}

impl Instruments<'_> {
    /// Columns `range` of B, (n·M) × as many.
    pub(super) fn columns(
        &self,
        observation: &Observation,
        range: Range<usize>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let of = |matrix: &DMatrix<f64>| {
            let rows = matrix.nrows();
            DMatrix::from_vec(rows, range.len(), matrix.as_slice()[range.start * rows..range.end * rows].to_vec())
        };
        Ok(match self {
            Self::Regressor => of(&observation.regressor),
            Self::Weighted(weights) => (*weights).clone().precision(&of(&observation.regressor), &observation.used)?,
            Self::Rows(rows) => of(rows),
        })
    }

    /// `Bᵀ S` for S of n·M rows.
    pub(super) fn transposed_product(
        &self,
        observation: &Observation,
        s: &DMatrix<f64>,
    ) -> Result<DMatrix<f64>, EstimationError> {
        let product = |b: &DMatrix<f64>, s: &DMatrix<f64>| transposed_product(b.as_slice(), s.as_slice(), s.nrows());
        Ok(match self {
            Self::Regressor => product(&observation.regressor, s),
            // B is never held as a whole: Bᵀ S = Wᵀ (Σ⁻¹ S).
            Self::Weighted(weights) => {
                product(&observation.regressor, &(*weights).clone().precision(s, &observation.used)?)
            }
            Self::Rows(rows) => product(rows, s),
        })
    }
}
