//! What a measurement does at points around the mean.
//!
//! ```text
//! χ_i = γ ± h S_i        Z_i = H χ_i
//! ```

use nalgebra::{DMatrix, DVector};

/// Z at the mean, and at the points `± h S_i`, m × b each.
pub(super) struct SigmaPoints {
    pub(super) centre: DVector<f64>,
    pub(super) plus: DMatrix<f64>,
    pub(super) minus: DMatrix<f64>,
}

impl SigmaPoints {
    /// Points at a distance `h` along the columns of the root (b × b).
    pub(super) fn of(measure: &DMatrix<f64>, mean: &DVector<f64>, root: &DMatrix<f64>, h: f64) -> Self {
        let b = mean.len();
        let at = |side: f64| {
            let points = DMatrix::from_fn(b, b, |i, j| mean[i] + side * h * root[(i, j)]);
            measure * points
        };
        Self { centre: measure * mean, plus: at(1.0), minus: at(-1.0) }
    }

    /// Weighted mean, with `centre` for the mean itself and `other` for each other point.
    pub(super) fn mean(&self, centre: f64, other: f64) -> DVector<f64> {
        let m = self.centre.len();
        let sum = |i: usize| self.plus.row(i).sum() + self.minus.row(i).sum();
        DVector::from_fn(m, |i, _| centre * self.centre[i] + other * sum(i))
    }
}
