//! Products of many short rows, of which each column stands in lines of eight.
//!
//! ```text
//! Wᵀ W        W S
//! ```
//! Every entry is one running sum in the order of its index, so blocks leave no trace in the bits.

use pulp::{Arch, Simd, WithSimd};

use crate::regressor::BLOCKS_OF_PART;

/// Rows of a line: those that the regressor gives at once.
const LINE: usize = BLOCKS_OF_PART;

/// Columns of a block. Sixteen sums fill half the registers of any 64-bit processor.
const BLOCK: usize = 4;
/// Columns of the right side of a product where vectors hold as many: four rows of them are four vectors.
const WIDE: usize = 8;

/// Rows of `width` numbers. Columns beyond fill up the last block with zeros.
#[derive(Clone, Debug)]
pub(super) struct ColumnLines {
    width: usize,
    stride: usize,
    /// Column c of rows 8 l to 8 l + 7 is line `l · stride + c`.
    lines: Vec<[f64; LINE]>,
}

/// A square matrix in rows of whole blocks.
#[derive(Clone, Debug)]
pub(super) struct Square {
    width: usize,
    stride: usize,
    values: Vec<f64>,
}

impl Square {
    /// Row r.
    pub(super) fn row(&self, r: usize) -> &[f64] {
        &self.values[r * self.stride..][..self.width]
    }

    /// Row r, to be written.
    pub(super) fn row_mut(&mut self, r: usize) -> &mut [f64] {
        &mut self.values[r * self.stride..][..self.width]
    }

    /// Products of the columns from `left` on with `WIDTH` from `right` on, over all `rows`.
    #[inline(always)]
    fn add_block<const WIDTH: usize>(&mut self, rows: &[f64], are_first: bool, left: usize, right: usize) {
        let stride = self.stride;
        let mut sums = [[0.0; WIDTH]; BLOCK];
        if !are_first {
            for (r, sums) in sums.iter_mut().enumerate() {
                *sums = *block(&self.values[(left + r) * stride..], right);
            }
        }
        for row in rows.chunks_exact(stride) {
            let (a, b) = (block::<BLOCK>(row, left), block::<WIDTH>(row, right));
            for r in 0..BLOCK {
                for c in 0..WIDTH {
                    sums[r][c] += a[r] * b[c];
                }
            }
        }
        for (r, sums) in sums.iter().enumerate() {
            self.values[(left + r) * stride + right..][..WIDTH].copy_from_slice(sums);
        }
    }
}

impl ColumnLines {
    /// `count` rows of `width` zeros, kept in whole lines.
    pub(super) fn zeros(count: usize, width: usize) -> Self {
        let stride = width.next_multiple_of(BLOCK);
        Self { width, stride, lines: vec![[0.0; LINE]; count.div_ceil(LINE) * stride] }
    }

    /// Zeros, one for each product of two of these columns.
    pub(super) fn square(&self) -> Square {
        Square { width: self.width, stride: self.stride, values: vec![0.0; self.stride * self.stride] }
    }

    /// The lines that begin with row `first`, a multiple of eight, column by column.
    pub(super) fn part(&self, first: usize) -> &[[f64; LINE]] {
        &self.lines[first / LINE * self.stride..][..self.width]
    }

    /// [`Self::part`], to be written.
    pub(super) fn part_mut(&mut self, first: usize) -> &mut [[f64; LINE]] {
        &mut self.lines[first / LINE * self.stride..][..self.width]
    }

    /// Row k.
    pub(super) fn row(&self, k: usize) -> impl Iterator<Item = f64> {
        self.part(k / LINE * LINE).iter().map(move |line| line[k % LINE])
    }

    /// Row k, to be written.
    pub(super) fn row_mut(&mut self, k: usize) -> impl Iterator<Item = &mut f64> {
        self.part_mut(k / LINE * LINE).iter_mut().map(move |line| &mut line[k % LINE])
    }

    /// Sets all rows from row k on to zero.
    pub(super) fn clear_from(&mut self, k: usize) {
        for (part, lines) in self.lines.chunks_exact_mut(self.stride.max(1)).enumerate().skip(k / LINE) {
            let first = k.saturating_sub(part * LINE);
            lines.iter_mut().for_each(|line| line[first..].fill(0.0));
        }
    }

    /// `Wᵀ W` in the place of what `gram` held, or, of further rows, added as if all came at once. What is below the diagonal means
    /// nothing; `room` is overwritten.
    pub(super) fn gram(&self, are_first: bool, gram: &mut Square, room: &mut Vec<f64>) {
        if self.width > 0 {
            Arch::new().dispatch(Gram { rows: self, are_first, gram, room });
        }
    }

    /// Blocks are `WIDTH` columns wide, and where fewer are left, [`BLOCK`].
    #[inline(always)]
    fn blocks_of_gram<const WIDTH: usize>(&self, are_first: bool, gram: &mut Square, rows: &mut Vec<f64>) {
        let stride = self.stride;
        // Neighbours in a row side by side, so that a vector holds them.
        rows.resize(self.lines.len() * LINE, 0.0);
        for (tile, lines) in rows.chunks_exact_mut(LINE * stride).zip(self.lines.chunks_exact(stride)) {
            for (left, columns) in lines.as_chunks::<BLOCK>().0.iter().enumerate() {
                for r in 0..LINE {
                    let to = tile[r * stride + left * BLOCK..].first_chunk_mut::<BLOCK>().expect("whole blocks");
                    *to = columns.map(|line| line[r]);
                }
            }
        }
        for left in (0..stride).step_by(BLOCK) {
            let mut right = left;
            while right + WIDTH <= stride {
                gram.add_block::<WIDTH>(rows, are_first, left, right);
                right += WIDTH;
            }
            for right in (right..stride).step_by(BLOCK) {
                gram.add_block::<BLOCK>(rows, are_first, left, right);
            }
        }
    }

    /// Writes `W S` in the place of what `product` held.
    pub(super) fn times(&self, square: &Square, product: &mut Self) {
        if self.width > 0 {
            Arch::new().dispatch(Product(self, square, product));
        }
    }

    #[inline(always)]
    fn blocks_of_product(&self, square: &Square, product: &mut Self) {
        let stride = self.stride;
        for (lines, product) in self.lines.chunks_exact(stride).zip(product.lines.chunks_exact_mut(stride)) {
            for (to, left) in product.as_chunks_mut::<BLOCK>().0.iter_mut().zip((0..).step_by(BLOCK)) {
                let mut sums = [[0.0; LINE]; BLOCK];
                for (line, from) in lines.iter().zip(square.values.chunks_exact(stride)) {
                    let factors = block::<BLOCK>(from, left);
                    for c in 0..BLOCK {
                        for r in 0..LINE {
                            sums[c][r] += line[r] * factors[c];
                        }
                    }
                }
                *to = sums;
            }
        }
    }
}

/// The loops of a product compiled for the vectors of the processor, by their width alone: the sums are those of the text.
struct Gram<'a> {
    rows: &'a ColumnLines,
    are_first: bool,
    gram: &'a mut Square,
    room: &'a mut Vec<f64>,
}

impl WithSimd for Gram<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { rows, are_first, gram, room } = self;
        if S::F64_LANES < WIDE {
            rows.blocks_of_gram::<BLOCK>(are_first, gram, room);
        } else {
            rows.blocks_of_gram::<WIDE>(are_first, gram, room);
        }
    }
}

/// As [`Gram`], of rows and a square matrix.
struct Product<'a>(&'a ColumnLines, &'a Square, &'a mut ColumnLines);

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.blocks_of_product(self.1, self.2);
    }
}

/// A block's worth of a row.
#[inline(always)]
fn block<const WIDTH: usize>(row: &[f64], start: usize) -> &[f64; WIDTH] {
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
            let mut rows = ColumnLines::zeros(count, width);
            for (k, row) in w.row_iter().enumerate() {
                rows.row_mut(k).zip(row.iter()).for_each(|(to, from)| *to = *from);
                assert!(rows.row(k).eq(row.iter().copied()));
            }
            let mut gram = rows.square();
            rows.gram(true, &mut gram, &mut Vec::new());
            let expected = w.tr_mul(&w);
            for r in 0..width {
                for c in r..width {
                    assert!((gram.row(r)[c] - expected[(r, c)]).abs() < 1e-13 * count as f64);
                }
            }
            let mut square = rows.square();
            for r in 0..width {
                square.row_mut(r).copy_from_slice(&s.row(r).iter().copied().collect::<Vec<_>>());
            }
            let mut product = rows.clone();
            rows.times(&square, &mut product);
            let expected = &w * &s;
            for k in 0..count {
                for (c, found) in product.row(k).enumerate() {
                    assert!((found - expected[(k, c)]).abs() < 1e-13 * width as f64);
                }
            }
            rows.clear_from(count / 2);
            for (k, row) in w.row_iter().enumerate() {
                assert!(
                    rows.row(k).zip(row.iter()).all(|(kept, from)| kept == if k < count / 2 { *from } else { 0.0 })
                );
            }
        }
    }
}
