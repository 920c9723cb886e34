//! Products of many short rows, in blocks that stay in the processor's registers.
//!
//! ```text
//! Wᵀ W        W S
//! ```
//! Every entry is one running sum in the order of its index, so blocks leave no trace in the bits.

use pulp::{Arch, Simd, WithSimd};

/// Rows and columns of a block. Sixteen sums fill half the registers of any 64-bit processor.
const BLOCK: usize = 4;

/// Equally long rows of numbers.
#[derive(Clone, Debug)]
pub(super) struct PaddedRows {
    width: usize,
    stride: usize,
    values: Vec<f64>,
}

impl PaddedRows {
    /// `count` rows of `width` zeros, kept in whole blocks.
    pub(super) fn zeros(count: usize, width: usize) -> Self {
        let stride = width.next_multiple_of(BLOCK);
        Self { width, stride, values: vec![0.0; count.next_multiple_of(BLOCK) * stride] }
    }

    /// Row k.
    pub(super) fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.stride..][..self.width]
    }

    /// Row k, to be written.
    pub(super) fn row_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.values[k * self.stride..][..self.width]
    }

    /// Sets all rows from row k on to zero.
    pub(super) fn clear_from(&mut self, k: usize) {
        self.values[k * self.stride..].fill(0.0);
    }

    /// Adds `Wᵀ W` to as many rows as these have columns; what is below their diagonal means nothing. Rows that come in parts are
    /// added as if all came at once.
    pub(super) fn add_gram(&self, gram: &mut Self) {
        Arch::new().dispatch(Gram(self, gram));
    }

    #[inline(always)]
    fn add_blocks_of_gram(&self, gram: &mut Self) {
        let stride = self.stride;
        for left in (0..stride).step_by(BLOCK) {
            for right in (left..stride).step_by(BLOCK) {
                let mut sums = [[0.0; BLOCK]; BLOCK];
                for (r, sums) in sums.iter_mut().enumerate() {
                    *sums = *block(&gram.values[(left + r) * stride..], right);
                }
                for row in self.values.chunks_exact(stride) {
                    let (a, b) = (block(row, left), block(row, right));
                    for r in 0..BLOCK {
                        for c in 0..BLOCK {
                            sums[r][c] += a[r] * b[c];
                        }
                    }
                }
                for (r, sums) in sums.iter().enumerate() {
                    gram.values[(left + r) * stride + right..][..BLOCK].copy_from_slice(sums);
                }
            }
        }
    }

    /// `W S` for a square matrix with as many rows as these have columns.
    pub(super) fn times(&self, square: &Self) -> Self {
        Arch::new().dispatch(Product(self, square))
    }

    #[inline(always)]
    fn blocks_of_product(&self, square: &Self) -> Self {
        let (stride, mut product) = (self.stride, self.clone());
        let tiles = self.values.chunks_exact(BLOCK * stride);
        for (rows, product) in tiles.zip(product.values.chunks_exact_mut(BLOCK * stride)) {
            for column in (0..stride).step_by(BLOCK) {
                let mut sums = [[0.0; BLOCK]; BLOCK];
                for (k, from) in square.values.chunks_exact(stride).enumerate() {
                    let b = block(from, column);
                    for r in 0..BLOCK {
                        let a = rows[r * stride + k];
                        for c in 0..BLOCK {
                            sums[r][c] += a * b[c];
                        }
                    }
                }
                for (r, sums) in sums.iter().enumerate() {
                    product[r * stride + column..][..BLOCK].copy_from_slice(sums);
                }
            }
        }
        product
    }
}

/// The loops of a product compiled for the vectors of the processor, by their width alone: the sums are those of the text.
struct Gram<'a>(&'a PaddedRows, &'a mut PaddedRows);

impl WithSimd for Gram<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.add_blocks_of_gram(self.1);
    }
}

/// As [`Gram`], of rows and a square matrix.
struct Product<'a>(&'a PaddedRows, &'a PaddedRows);

impl WithSimd for Product<'_> {
    type Output = PaddedRows;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> PaddedRows {
        self.0.blocks_of_product(self.1)
    }
}

/// A block's worth of a row.
#[inline(always)]
fn block(row: &[f64], start: usize) -> &[f64; BLOCK] {
    row[start..].first_chunk().expect("rows are padded to whole blocks")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use nalgebra::DMatrix;
    use rand::RngExt;

    #[test]
    fn identity_products_equal_those_of_whole_matrices() {
        for (count, width) in [(1, 1), (5, 3), (8, 4), (23, 13), (100, 37)] {
            let mut rng = Seed::new(4).stream("rows", width as u64);
            let w = DMatrix::from_fn(count, width, |_, _| rng.random_range(-1.0..1.0));
            let s = DMatrix::from_fn(width, width, |_, _| rng.random_range(-1.0..1.0));
            let padded = |matrix: &DMatrix<f64>| {
                let mut rows = PaddedRows::zeros(matrix.nrows(), matrix.ncols());
                for (k, row) in matrix.row_iter().enumerate() {
                    rows.row_mut(k).copy_from_slice(&row.iter().copied().collect::<Vec<_>>());
                }
                rows
            };
            let rows = padded(&w);
            let mut gram = PaddedRows::zeros(width, width);
            rows.add_gram(&mut gram);
            let expected = w.tr_mul(&w);
            for r in 0..width {
                for c in r..width {
                    assert!((gram.row(r)[c] - expected[(r, c)]).abs() < 1e-13 * count as f64);
                }
            }
            let product = rows.times(&padded(&s));
            let expected = &w * &s;
            for k in 0..count {
                for c in 0..width {
                    assert!((product.row(k)[c] - expected[(k, c)]).abs() < 1e-13 * width as f64);
                }
            }
        }
    }
}
