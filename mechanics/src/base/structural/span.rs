//! Finite-dimensional spaces of functionals.

use nalgebra::DMatrix;

use crate::linalg::{LeftToRight, RankTolerance};

/// Rows shorter than this are rounding, since lengths, axes and gravity are of size 1.
const SMALLEST_ROW: f64 = 1e-12;

/// A basis, in reduced row echelon form, of the space that these rows span; and the columns of its pivots.
///
/// Rows are scaled to unit length first: a functional weighs the same in any unit.
fn echelon(rows: &[Vec<f64>], width: usize) -> LeftToRight {
    let with_length = rows.iter().map(|row| (row.iter().map(|x| x * x).sum::<f64>().sqrt(), row));
    let scaled: Vec<(f64, &Vec<f64>)> = with_length.filter(|&(length, _)| length > SMALLEST_ROW).collect();
    let matrix = DMatrix::from_fn(scaled.len(), width, |i, j| scaled[i].1[j] / scaled[i].0);
    LeftToRight::new(&matrix, RankTolerance::default())
}

/// Basis of the row space, in rows whose largest entries are near 1, so that what they are multiplied with keeps its size.
pub(super) fn basis(rows: &[Vec<f64>], width: usize) -> Vec<Vec<f64>> {
    let form = echelon(rows, width);
    let mut rows: Vec<Vec<f64>> = form.coefficients.row_iter().map(|row| row.iter().copied().collect()).collect();
    rows.iter_mut().for_each(|row| shrink(row));
    rows
}

/// Divides a row by a power of two, which costs no bit, so that its largest entry is near 1.
fn shrink(row: &mut [f64]) {
    let largest = row.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let factor = libm::ldexp(1.0, -libm::frexp(largest).1);
    row.iter_mut().for_each(|x| *x *= factor);
}

/// Rows in reduced echelon form but for a factor of each, so that their largest entries are near 1; to which others are added
/// that are zero up to the last pivot.
#[derive(Default)]
pub(super) struct EchelonRows {
    /// Pivots, ascending, with their rows.
    rows: Vec<(usize, Vec<f64>)>,
}

impl EchelonRows {
    /// Adds rows that are zero up to the last pivot. Only they are brought to echelon form; those of before lose their entries
    /// at the new pivots. It costs as much as there are entries other than zero in the new ones, times the rows.
    pub(super) fn add(&mut self, fresh: &[Vec<f64>], width: usize) {
        let form = echelon(fresh, width);
        for (&pivot, new) in form.kept.iter().zip(form.coefficients.row_iter()) {
            let entries: Vec<(usize, f64)> = new.iter().copied().enumerate().filter(|(_, x)| *x != 0.0).collect();
            for (_, row) in &mut self.rows {
                let factor = row[pivot];
                if factor != 0.0 {
                    entries.iter().for_each(|&(column, x)| row[column] -= factor * x);
                    row[pivot] = 0.0;
                }
            }
        }
        self.rows.extend(
            form.kept
                .iter()
                .zip(form.coefficients.row_iter())
                .map(|(&pivot, row)| (pivot, row.iter().copied().collect())),
        );
        self.rows.iter_mut().for_each(|(_, row)| shrink(row));
    }

    /// Takes away the rows whose pivot is `column` or one beyond.
    pub(super) fn split_off(&mut self, column: usize) -> Vec<Vec<f64>> {
        let at = self.rows.partition_point(|&(pivot, _)| pivot < column);
        self.rows.split_off(at).into_iter().map(|(_, row)| row).collect()
    }

    /// The rows.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[f64]> {
        self.rows.iter().map(|(_, row)| row.as_slice())
    }

    /// The rows, to be changed beyond their pivots.
    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        self.rows.iter_mut().map(|(_, row)| row.as_mut_slice())
    }

    /// Pivots and rows, each divided by its entry there.
    pub(super) fn finish(self) -> impl Iterator<Item = (usize, Vec<f64>)> {
        self.rows.into_iter().map(|(pivot, row)| (pivot, row.iter().map(|x| x / row[pivot]).collect()))
    }
}
