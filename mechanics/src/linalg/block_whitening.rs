//! Weights for rows that come in blocks, one block per sample, each with the same covariance.
//!
//! ```text
//! Σ = L Lᵀ        w̃ = L⁻¹ w        (L⁻¹ w)ᵀ (L⁻¹ w) = wᵀ Σ⁻¹ w
//! ```
//! Rows that are no equations stay zero, and the others of their block are weighted with their own part of Σ.

use nalgebra::{Cholesky, DMatrix, Dyn};

use super::least_squares::LeastSquaresError;
use super::product::add_product;

/// Divides blocks of n rows by the root of their covariance, so that they have unit covariance.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::BlockWhitening;
/// use nalgebra::dmatrix;
/// let mut whitening = BlockWhitening::new(&dmatrix![4.0, 0.0; 0.0, 9.0])?;
/// let white = whitening.whiten(&dmatrix![2.0; 3.0; 4.0; 6.0], &[true; 4])?;
/// assert_eq!(white, dmatrix![1.0; 1.0; 2.0; 2.0]);
/// # Ok::<(), armid::linalg::LeastSquaresError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BlockWhitening {
    covariance: DMatrix<f64>,
    /// One factor for each pattern of used rows met so far; the first is that of all rows.
    factors: Vec<(Vec<bool>, Cholesky<f64, Dyn>)>,
}

impl BlockWhitening {
    /// The whitening of blocks of covariance `covariance` (n × n).
    ///
    /// # Errors
    /// [`LeastSquaresError::Covariance`] unless it is positive definite.
    pub fn new(covariance: &DMatrix<f64>) -> Result<Self, LeastSquaresError> {
        let size = covariance.nrows();
        let factor = Cholesky::new(covariance.clone())
            .filter(|factor| factor.l_dirty().diagonal().iter().all(|&d| d.is_finite() && d > 0.0))
            .ok_or(LeastSquaresError::Covariance { size })?;
        Ok(Self { covariance: covariance.clone(), factors: vec![(vec![true; size], factor)] })
    }

    /// `L⁻¹` times every block of rows of W ((n·M) × b); `used` (n·M) marks the rows that are equations.
    ///
    /// # Errors
    /// [`LeastSquaresError::Blocks`] where the rows are no multiple of n, or not as many as marks.
    pub fn whiten(&mut self, w: &DMatrix<f64>, used: &[bool]) -> Result<DMatrix<f64>, LeastSquaresError> {
        self.on_blocks(w, used, |rows, block| {
            let mut rest = rows;
            for i in 0..block.len() {
                let (row, others) = rest.split_at(i + 1);
                let sum: f64 = row.iter().zip(&block[..i]).map(|(l, x)| l * x).sum();
                block[i] = (block[i] - sum) / row[i];
                rest = others;
            }
        })
    }

    /// `L⁻ᵀ` times every block of rows: after [`Self::whiten`], `Σ⁻¹ W`.
    ///
    /// # Errors
    /// As [`Self::whiten`].
    pub fn whiten_transposed(&mut self, w: &DMatrix<f64>, used: &[bool]) -> Result<DMatrix<f64>, LeastSquaresError> {
        self.on_blocks(w, used, |rows, block| {
            let entry = |i: usize, j: usize| rows[i * (i + 1) / 2 + j];
            for i in (0..block.len()).rev() {
                let sum: f64 = (i + 1..block.len()).map(|j| entry(j, i) * block[j]).sum();
                block[i] = (block[i] - sum) / entry(i, i);
            }
        })
    }

    /// `Σ⁻¹` times every block of rows.
    ///
    /// # Errors
    /// As [`Self::whiten`].
    pub fn precision(&mut self, w: &DMatrix<f64>, used: &[bool]) -> Result<DMatrix<f64>, LeastSquaresError> {
        self.precision_of_columns(w.as_slice(), w.nrows(), used)
    }

    /// The same for columns of `rows` numbers that follow each other; a part of a column at the end is left out.
    ///
    /// # Errors
    /// As [`Self::whiten`].
    pub fn precision_of_columns(
        &mut self,
        columns: &[f64],
        rows: usize,
        used: &[bool],
    ) -> Result<DMatrix<f64>, LeastSquaresError> {
        let (size, patterns) = (self.covariance.nrows(), self.patterns(rows, used)?);
        let inverses: Vec<DMatrix<f64>> = self.factors.iter().map(|(_, factor)| factor.inverse()).collect();
        let mut out = DMatrix::zeros(rows, columns.len().checked_div(rows).unwrap_or(0));
        for (mut to, from) in out.column_iter_mut().zip(columns.chunks_exact(rows.max(1))) {
            let (to, mut first) = (to.as_mut_slice(), 0);
            // Blocks are columns in memory, and neighbours mostly have the same rows.
            for alike in patterns.chunk_by(|a, b| a == b) {
                let rows = first..first + alike.len() * size;
                first = rows.end;
                add_product(inverses[alike[0]].as_slice(), &from[rows.clone()], size, &mut to[rows]);
            }
        }
        Ok(out)
    }

    /// Hands each block, with the rows of L one after another up to their diagonals, to `solve`.
    fn on_blocks(
        &mut self,
        w: &DMatrix<f64>,
        used: &[bool],
        solve: impl Fn(&[f64], &mut [f64]),
    ) -> Result<DMatrix<f64>, LeastSquaresError> {
        let (size, patterns) = (self.covariance.nrows(), self.patterns(w.nrows(), used)?);
        let rows = |(_, factor): &(Vec<bool>, Cholesky<f64, Dyn>)| -> Vec<f64> {
            (0..size).flat_map(|i| (0..=i).map(move |j| factor.l_dirty()[(i, j)])).collect()
        };
        let factors: Vec<Vec<f64>> = self.factors.iter().map(rows).collect();
        let mut out = w.clone();
        // Columns are contiguous and hold whole numbers of blocks.
        for mut column in out.column_iter_mut() {
            for (block, &pattern) in column.as_mut_slice().chunks_exact_mut(size).zip(&patterns) {
                solve(&factors[pattern], block);
            }
        }
        Ok(out)
    }

    /// Where the factor of each block of rows is.
    fn patterns(&mut self, rows: usize, used: &[bool]) -> Result<Vec<usize>, LeastSquaresError> {
        let size = self.covariance.nrows();
        if !rows.is_multiple_of(size) || used.len() != rows {
            return Err(LeastSquaresError::Blocks { rows, size });
        }
        used.chunks_exact(size).map(|used| self.pattern(used)).collect()
    }

    /// Where the factor for a pattern of used rows is: Σ with the unused rows and columns those of the identity, so
    /// that they take no part.
    fn pattern(&mut self, used: &[bool]) -> Result<usize, LeastSquaresError> {
        if let Some(found) = self.factors.iter().position(|(pattern, _)| pattern == used) {
            return Ok(found);
        }
        let size = used.len();
        let part = DMatrix::from_fn(size, size, |i, j| {
            if used[i] && used[j] { self.covariance[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        let factor = Cholesky::new(part).ok_or(LeastSquaresError::Covariance { size })?;
        self.factors.push((used.to_vec(), factor));
        Ok(self.factors.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::LeastSquares;
    use crate::seed::Seed;
    use rand::RngExt;

    fn random(rows: usize, columns: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(2).stream("block whitening", run);
        DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
    }

    #[test]
    fn identity_row_scaling_with_the_matching_weight_changes_nothing() {
        let (w, y) = (random(40, 5, 3), random(40, 1, 4));
        let plain = LeastSquares::solve(&w, &y.column(0).into_owned()).unwrap();
        // Rows of joint 0 times 10 and of joint 1 times 0.1, with Σ to match.
        let mut whitening = BlockWhitening::new(&nalgebra::dmatrix![100.0, 0.0; 0.0, 0.01]).unwrap();
        let mut scale = |m: &DMatrix<f64>| {
            let mut m = m.clone();
            for (i, mut row) in m.row_iter_mut().enumerate() {
                row *= if i % 2 == 0 { 10.0 } else { 0.1 };
            }
            whitening.whiten(&m, &[true; 40]).unwrap()
        };
        let weighted = LeastSquares::solve(&scale(&w), &scale(&y).column(0).into_owned()).unwrap();
        assert!((plain.solution() - weighted.solution()).norm() < 1e-13 * plain.solution().norm());
    }

    #[test]
    fn identity_whitening_is_the_inverse_root() {
        let root = random(3, 3, 5) + DMatrix::identity(3, 3) * 3.0;
        let covariance = &root * root.transpose();
        let mut whitening = BlockWhitening::new(&covariance).unwrap();
        let w = random(12, 2, 6);
        let white = whitening.whiten(&w, &[true; 12]).unwrap();
        let both = whitening.whiten_transposed(&white, &[true; 12]).unwrap();
        assert!((&both - whitening.precision(&w, &[true; 12]).unwrap()).norm() < 1e-13);
        for k in 0..4 {
            let back = &covariance * both.rows(3 * k, 3);
            assert!((back - w.rows(3 * k, 3)).norm() < 1e-13);
        }
        assert_eq!(whitening.whiten(&random(4, 1, 7), &[true; 4]), Err(LeastSquaresError::Blocks { rows: 4, size: 3 }));
        assert!(BlockWhitening::new(&nalgebra::dmatrix![1.0, 2.0; 2.0, 1.0]).is_err());
    }

    #[test]
    fn identity_rows_that_are_left_out_take_no_part() {
        let root = random(3, 3, 8) + DMatrix::identity(3, 3) * 2.0;
        let covariance = &root * root.transpose();
        let mut whitening = BlockWhitening::new(&covariance).unwrap();
        let mut w = random(6, 2, 9);
        let used = [true, false, true, true, true, true];
        w.row_mut(1).fill(0.0);
        let white = whitening.whiten(&w, &used).unwrap();
        assert_eq!(white.row(1).amax(), 0.0);
        // The first block by hand: joints 0 and 2 with their own covariance.
        let keep = [0, 2];
        let part = covariance.select_rows(&keep).select_columns(&keep).try_inverse().unwrap();
        let rows = w.select_rows(&keep);
        let expected = rows.transpose() * part * rows;
        let found = white.rows(0, 3).transpose() * white.rows(0, 3);
        assert!((found - &expected).norm() < 1e-13);
        let precision = whitening.precision(&w, &used).unwrap();
        assert!((w.rows(0, 3).transpose() * precision.rows(0, 3) - expected).norm() < 1e-13);
        assert_eq!(precision.row(1).amax(), 0.0);
        assert!(
            (white.rows(3, 3) - BlockWhitening::new(&covariance).unwrap().whiten(&w, &[true; 6]).unwrap().rows(3, 3))
                .norm()
                < 1e-15
        );
    }
}
