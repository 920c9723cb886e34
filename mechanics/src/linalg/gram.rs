//! Normal equations gathered row by row.

use nalgebra::{DMatrix, DVector};

/// The sums `WᵀW` (b × b), `Wᵀy` (b) and `yᵀy` over the rows added so far.
///
/// A trajectory of any length is gathered without ever holding W.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::Gram;
/// use nalgebra::{dmatrix, dvector};
/// let mut gram = Gram::new(2);
/// gram.add_row(&[1.0, 2.0], 1.0, 1.0);
/// gram.add_row(&[3.0, 4.0], -1.0, 1.0);
/// assert_eq!(gram.information(), dmatrix![10.0, 14.0; 14.0, 20.0]);
/// assert_eq!((&gram.moment, gram.rows), (&dvector![-2.0, -2.0], 2));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gram {
    /// Upper triangle of WᵀW; the lower one stays zero.
    pub(crate) upper: DMatrix<f64>,
    /// `Wᵀy`, length b.
    pub moment: DVector<f64>,
    /// `yᵀy`.
    pub energy: f64,
    /// Number of rows added.
    pub rows: usize,
}

impl Gram {
    /// No rows yet, for b columns.
    pub fn new(columns: usize) -> Self {
        Self { upper: DMatrix::zeros(columns, columns), moment: DVector::zeros(columns), energy: 0.0, rows: 0 }
    }

    /// Adds one row `w` (b) with its measurement `y` and the factor `weight` (1/σ²).
    ///
    /// # Panics
    /// If the row has not b entries.
    pub fn add_row(&mut self, w: &[f64], y: f64, weight: f64) {
        assert_eq!(w.len(), self.moment.len(), "one entry per column");
        for (j, &wj) in w.iter().enumerate() {
            let scaled = wj * weight;
            for (entry, &wi) in self.upper.column_mut(j).as_mut_slice().iter_mut().zip(&w[..=j]) {
                *entry += wi * scaled;
            }
            self.moment[j] += scaled * y;
        }
        self.energy += y * y * weight;
        self.rows += 1;
    }

    /// `WᵀW`, b × b, symmetric.
    pub fn information(&self) -> DMatrix<f64> {
        let b = self.moment.len();
        DMatrix::from_fn(b, b, |i, j| self.upper[(i.min(j), i.max(j))])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_rows_one_by_one_give_the_products_of_the_whole() {
        let w = DMatrix::from_fn(30, 4, |i, j| libm::sin((7 * i + 3 * j) as f64));
        let y = DVector::from_fn(30, |i, _| libm::cos(i as f64));
        let mut whole = Gram::new(4);
        for (row, &y) in w.row_iter().zip(&y) {
            whole.add_row(row.into_owned().as_slice(), y, 1.0);
        }
        assert!((whole.information() - w.tr_mul(&w)).norm() < 1e-13);
        assert!((&whole.moment - w.tr_mul(&y)).norm() < 1e-13);
        assert!((whole.energy - y.norm_squared()).abs() < 1e-13);
    }
}
