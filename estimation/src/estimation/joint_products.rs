//! Products of the equations of every two joints, summed over samples.
//!
//! ```text
//! S_ij = Σ_k w_ikᵀ w_jk        Σ_k W_kᵀ Q W_k = Σ_ij Q_ij S_ij        for any Q (n × n)
//! ```
//! Of a joint only the columns that act on it count, which are less than half of all.

use nalgebra::DMatrix;

use super::entries::{joint_entries, put_joint_entries};
use crate::linalg::column_squares;

/// S of all joints, b × b each, without columns that are zero.
#[derive(Clone, Debug)]
pub(super) struct JointProducts {
    /// Joint and column of each row, and of each column.
    places: Vec<(usize, usize)>,
    /// Joint, first column and number of columns of places that follow each other.
    runs: Vec<(usize, usize, usize)>,
    sums: DMatrix<f64>,
    /// b.
    columns: usize,
}

impl JointProducts {
    /// Of the first b columns of `rows`, (n · samples) × at least b, of joints that are equations.
    pub(super) fn new(rows: &DMatrix<f64>, columns: usize, used: &[bool]) -> Self {
        let dof = used.len();
        let places: Vec<(usize, usize)> = (0..dof)
            .filter(|&i| used[i])
            .flat_map(|i| (0..columns).map(move |j| (i, j)))
            .filter(|&(i, j)| joint_entries(rows, dof, i, j).any(|entry| entry != 0.0))
            .collect();
        let mut entries = DMatrix::zeros(rows.nrows() / dof, places.len());
        for (mut column, &(i, j)) in entries.column_iter_mut().zip(&places) {
            put_joint_entries(rows, dof, i, j, column.as_mut_slice());
        }
        let runs = places.chunk_by(|a, b| a.0 == b.0 && a.1 + 1 == b.1).map(|run| (run[0].0, run[0].1, run.len()));
        Self { sums: column_squares(&entries), runs: runs.collect(), places, columns }
    }

    /// `Σ_k W_kᵀ Q W_k`, b × b, for Q (n × n).
    pub(super) fn between(&self, q: &DMatrix<f64>) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(self.columns, self.columns);
        for (sums, &(j, column)) in self.sums.column_iter().zip(&self.places) {
            let (mut sum, q, mut rest) = (sum.column_mut(column), q.column(j), sums.as_slice());
            for &(i, row, count) in &self.runs {
                let (own, after) = rest.split_at(count);
                rest = after;
                let size = q[i];
                if size != 0.0 {
                    let to = &mut sum.as_mut_slice()[row..row + count];
                    to.iter_mut().zip(own).for_each(|(sum, of_pair)| *sum += size * of_pair);
                }
            }
        }
        sum
    }
}
