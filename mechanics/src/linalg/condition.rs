//! Condition numbers.

use nalgebra::{DMatrix, DVector};

use super::reflection::norm;
use super::triangular::triangular_factor;

/// Singular values of A (m × n), largest first, through its triangular factor unless it is square.
pub fn singular_values(a: &DMatrix<f64>) -> DVector<f64> {
    let factor = if a.is_square() { a.clone() } else { triangular_factor(a) };
    let mut values = factor.svd(false, false).singular_values;
    values.as_mut_slice().sort_by(|x, y| y.total_cmp(x));
    values
}

/// Condition number `σ_max / σ_min` of A (m × n, m ≥ n): how much larger the relative error of a least-squares
/// solution can be than that of the data. Infinite where a singular value is zero; 1 for a matrix without columns.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::{condition, condition_scaled};
/// use nalgebra::dmatrix;
/// let a = dmatrix![3.0, 0.0; 0.0, 0.5; 0.0, 0.0];
/// assert!((condition(&a) - 6.0).abs() < 1e-14);
/// assert!((condition_scaled(&a) - 1.0).abs() < 1e-14);
/// ```
pub fn condition(a: &DMatrix<f64>) -> f64 {
    if a.ncols() == 0 {
        return 1.0;
    }
    if a.nrows() < a.ncols() {
        return f64::INFINITY;
    }
    let values = singular_values(a);
    values[0] / values[values.len() - 1]
}

/// Condition number of A with each column scaled to unit length, which does not depend on the parameters' units.
pub fn condition_scaled(a: &DMatrix<f64>) -> f64 {
    condition(&normalised_columns(a).0)
}

/// A with each column divided by its length, and the lengths (n); a zero column stays as it is.
pub fn normalised_columns(a: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let mut scaled = a.clone();
    let mut lengths = DVector::zeros(a.ncols());
    for (mut column, length) in scaled.column_iter_mut().zip(lengths.iter_mut()) {
        *length = norm(column.as_slice());
        if *length > 0.0 {
            column.iter_mut().for_each(|x| *x /= *length);
        }
    }
    (scaled, lengths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_condition_of_the_hilbert_matrix() {
        // cond_2 of the 5 × 5 Hilbert matrix is 4.7661e5 (N. J. Higham, Accuracy and Stability, 2nd ed., table 28.1).
        let hilbert = DMatrix::from_fn(5, 5, |i, j| 1.0 / ((i + j + 1) as f64));
        assert!((condition(&hilbert) / 4.7661e5 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn identity_scaled_condition_ignores_units() {
        let a = DMatrix::from_fn(9, 3, |i, j| libm::sin((i * i + 3 * j * i + j + 1) as f64));
        let b = &a * DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 1.0, 1e-5]));
        // The factor 1e11 between columns costs the raw condition eleven digits and the scaled one none.
        assert!((condition_scaled(&a) - condition_scaled(&b)).abs() < 1e-12);
        assert!(condition(&b) > 1e10);
        assert!(condition(&DMatrix::zeros(2, 3)).is_infinite());
    }
}
