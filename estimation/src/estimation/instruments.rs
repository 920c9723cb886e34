//! What the equations are multiplied with to find β̂.
//!
//! ```text
//! Bᵀ (y − W β̂) = 0        B = W (OLS), Σ⁻¹ W (WLS), or any other (n·M) × b
//! ```

use std::borrow::Cow;
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
    /// Columns `range` of B, n·M numbers each.
    pub(super) fn columns<'b>(
        &'b self,
        observation: &'b Observation,
        range: Range<usize>,
    ) -> Result<Cow<'b, [f64]>, EstimationError> {
        let (w, used) = (&observation.regressor, &observation.used);
        let rows = w.nrows();
        let of = |matrix: &'b DMatrix<f64>| &matrix.as_slice()[range.start * rows..range.end * rows];
        Ok(match self {
            Self::Regressor => Cow::Borrowed(of(w)),
            Self::Weighted(weights) => {
                let weighted: Vec<f64> = (*weights).clone().precision_of_columns(of(w), rows, used)?.data.into();
                Cow::Owned(weighted)
            }
            Self::Rows(matrix) => Cow::Borrowed(of(matrix)),
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
