//! Triangular factors of a positive definite matrix, column by column.

use nalgebra::DMatrix;

use super::vectors::{axpy, dot};

/// Cholesky factor L, column by column, of which the lower triangle is set; `None` if not positive definite.
pub(super) fn lower_factor(matrix: &DMatrix<f64>) -> Option<Vec<f64>> {
    let n = matrix.nrows();
    let mut l = matrix.as_slice().to_vec();
    for k in 0..n {
        let pivot = l[k * n + k];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let root = pivot.sqrt();
        for value in &mut l[k * n + k..(k + 1) * n] {
            *value /= root;
        }
        let (done, rest) = l.split_at_mut((k + 1) * n);
        let column = &done[k * n..];
        for c in k + 1..n {
            let offset = (c - k - 1) * n;
            axpy(-column[c], &column[c..n], &mut rest[offset + c..offset + n]);
        }
    }
    Some(l)
}

/// L⁻ᵀ, column by column, from a lower factor.
pub(super) fn inverse_transposed(l: &[f64], n: usize) -> Vec<f64> {
    // Column c of L⁻ᵀ is row c of L⁻¹: solve Lᵀ x = e_c backwards; it has entries 0 ..= c only.
    let mut j = vec![0.0; n * n];
    for c in 0..n {
        let x = &mut j[c * n..c * n + c + 1];
        x[c] = 1.0 / l[c * n + c];
        for i in (0..c).rev() {
            x[i] = -dot(&l[i * n + i + 1..i * n + c + 1], &x[i + 1..=c]) / l[i * n + i];
        }
    }
    j
}

/// Turns columns x and y (x < y) of an n × n matrix.
pub(super) fn rotate(matrix: &mut [f64], n: usize, x: usize, y: usize, cos: f64, sin: f64) {
    let (head, tail) = matrix.split_at_mut(y * n);
    for (a, b) in head[x * n..(x + 1) * n].iter_mut().zip(&mut tail[..n]) {
        (*a, *b) = (cos * *a + sin * *b, cos * *b - sin * *a);
    }
}
