//! The inverse of a positive definite matrix.

use nalgebra::{Cholesky, DMatrix};

use super::product::transpose_product;

/// Columns that are multiplied at once.
const COLUMNS: usize = 8;

/// `A⁻¹ = L⁻ᵀ L⁻¹` of a symmetric positive definite `A = L Lᵀ`, n × n, of which the lower triangle is read; `None` where A has no such factor.
///
/// `L⁻¹` by columns, each from its diagonal down (n³/3 operations), then products of a few columns with those before them, from the
/// first row on that is not zero (n³/3), summed in a fixed order.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::definite_inverse;
/// use nalgebra::dmatrix;
/// let inverse = definite_inverse(dmatrix![4.0, 2.0; 2.0, 5.0]).unwrap();
/// assert!((inverse - dmatrix![5.0, -2.0; -2.0, 4.0] / 16.0).amax() < 1e-15);
/// assert!(definite_inverse(dmatrix![1.0, 2.0; 2.0, 1.0]).is_none());
/// ```
pub fn definite_inverse(a: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let factor = Cholesky::new(a)?.unpack();
    let mut inverse = DMatrix::identity(n, n);
    for (j, mut column) in inverse.column_iter_mut().enumerate() {
        let column = column.as_mut_slice();
        for i in j..n {
            column[i] /= factor[(i, i)];
            let (done, below) = column.split_at_mut(i + 1);
            let size = done[i];
            for (entry, of_factor) in below.iter_mut().zip(&factor.column(i).as_slice()[i + 1..]) {
                *entry -= size * of_factor;
            }
        }
    }
    let root = inverse;
    let mut inverse = DMatrix::zeros(n, n);
    for first in (0..n).step_by(COLUMNS) {
        let end = (first + COLUMNS).min(n);
        let columns = root.view((first, first), (n - first, end - first)).into_owned();
        let before = root.view((first, 0), (n - first, end)).into_owned();
        inverse.view_mut((0, first), (end, end - first)).copy_from(&transpose_product(&before, &columns));
    }
    inverse.fill_lower_triangle_with_upper_triangle();
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_the_matrix_times_its_inverse_is_one() {
        let root = DMatrix::from_fn(23, 23, |i, j| libm::sin((3 * i * i + 5 * j + 1) as f64));
        let a = &root * root.transpose() + DMatrix::identity(23, 23);
        let one = &a * definite_inverse(a.clone()).unwrap();
        assert!((one - DMatrix::identity(23, 23)).amax() < 1e-12);
        assert_eq!(definite_inverse(DMatrix::zeros(0, 0)).unwrap().shape(), (0, 0));
    }
}
