//! The triangular factor of a tall matrix, and solving with it.

use nalgebra::{DMatrix, DVector};

use super::reflection::{Reflection, norm};

/// Upper triangular (trapezoidal) factor R of `A = Q R`, min(m, n) × n, for A of m × n.
///
/// R has the singular values and the linear dependencies of A, so anything that needs only those may work on R. No
/// column is exchanged. Householder reflections, `2 m n²` operations; the signs of R's rows are not normalised.
pub fn triangular_factor(a: &DMatrix<f64>) -> DMatrix<f64> {
    let (m, n) = a.shape();
    let mut columns: Vec<Vec<f64>> = a.column_iter().map(|c| c.iter().copied().collect()).collect();
    for k in 0..m.min(n) {
        if norm(&columns[k][k..]) > 0.0 {
            let (head, tail) = columns.split_at_mut(k + 1);
            let reflection = Reflection::annihilate(&mut head[k], k);
            for column in tail {
                reflection.apply(column);
            }
        }
    }
    DMatrix::from_fn(m.min(n), n, |i, j| if i <= j { columns[j][i] } else { 0.0 })
}

/// Solves `R x = b` by back substitution, for R upper triangular (n × n, its diagonal without zeros) and b of length n.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::solve_upper;
/// use nalgebra::{dmatrix, dvector};
/// assert_eq!(solve_upper(&dmatrix![2.0, 1.0; 0.0, 4.0], &dvector![5.0, 4.0]), dvector![2.0, 1.0]);
/// ```
pub fn solve_upper(r: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let mut x = b.clone();
    for i in (0..b.len()).rev() {
        let mut sum = x[i];
        for j in i + 1..b.len() {
            sum -= r[(i, j)] * x[j];
        }
        x[i] = sum / r[(i, i)];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_gram_matrix_of_the_factor_is_that_of_the_matrix() {
        let a = DMatrix::from_fn(7, 4, |i, j| libm::sin((3 * i + 5 * j + 1) as f64));
        let r = triangular_factor(&a);
        assert!((a.tr_mul(&a) - r.tr_mul(&r)).norm() < 1e-14 * a.norm_squared());
        assert_eq!(r.shape(), (4, 4));
    }
}
