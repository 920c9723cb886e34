//! Finite-dimensional spaces of functionals.

use nalgebra::DMatrix;

use crate::linalg::{LeftToRight, RankTolerance};

/// Rows shorter than this are rounding, since lengths, axes and gravity are of size 1.
const SMALLEST_ROW: f64 = 1e-12;

/// A basis, in reduced row echelon form, of the space that these rows span; and the columns of its pivots.
///
/// Rows are scaled to unit length first: a functional weighs the same in any unit.
pub(super) fn echelon(rows: &[Vec<f64>], width: usize) -> LeftToRight {
    let scaled: Vec<(f64, &Vec<f64>)> = rows
        .iter()
        .map(|row| (row.iter().map(|x| x * x).sum::<f64>().sqrt(), row))
        .filter(|&(length, _)| length > SMALLEST_ROW)
        .collect();
    let matrix = DMatrix::from_fn(scaled.len(), width, |i, j| scaled[i].1[j] / scaled[i].0);
    LeftToRight::new(&matrix, RankTolerance::default())
}

/// The same basis as rows whose largest entries are near 1, so that what they are multiplied with keeps its size: each
/// is divided by a power of two, which costs no bit.
pub(super) fn basis(rows: &[Vec<f64>], width: usize) -> Vec<Vec<f64>> {
    let form = echelon(rows, width);
    let scaled = |row: nalgebra::RowDVector<f64>| {
        let factor = libm::ldexp(1.0, -libm::frexp(row.amax()).1);
        row.iter().map(|x| x * factor).collect()
    };
    form.coefficients.row_iter().map(|row| scaled(row.into_owned())).collect()
}
