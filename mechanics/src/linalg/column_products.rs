//! Products of the columns of rows that come one after another.
//!
//! ```text
//! G = WᵀW = Σ_k w_k w_kᵀ, c × c
//! ```
//! Half of the operations of a [`RowFactor`](super::RowFactor), but a squared condition number: what is found from G has lost
//! about `c ε κ²` of itself. Each entry is summed in eight running sums, row k in sum k mod 8, and 128 rows at a time, the same
//! bits on any processor.
//!
//! Reference: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., SIAM 2002, sec. 10.3 and 20.4.

use std::ops::Range;

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Running sums of one entry.
const SUMS: usize = 8;
/// Lines of eight rows that are held of each column: of 150 columns they fit into the second cache.
const DEPTH: usize = 16;
/// Sums of squares below this have lost digits to the smallest number.
const LEAST_SQUARE: f64 = 1e-290;

/// A number of each of eight rows or blocks of samples, in a cache line of its own, so that no access touches two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Line(pub(crate) [f64; SUMS]);

impl Line {
    pub(crate) const ZERO: Self = Self([0.0; SUMS]);

    /// Its sum, in the one order.
    pub(crate) fn sum(&self) -> f64 {
        let s = &self.0;
        ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))
    }
}

/// `WᵀW` of a matrix that comes in rows.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::ColumnProducts;
/// use nalgebra::dmatrix;
/// let mut products = ColumnProducts::new(2);
/// products.add(3, |column, rows| rows.map(move |row| [[3.0, 1.0], [0.0, 2.0], [4.0, 1.0]][row][column]));
/// let squares = products.clone().finish();
/// assert_eq!(squares, dmatrix![25.0, 7.0; 7.0, 6.0]);
/// let root = products.root().unwrap();
/// assert!((root.tr_mul(&root) - squares).amax() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct ColumnProducts {
    columns: usize,
    /// Rows that wait: `column · DEPTH + line`.
    held: Vec<Line>,
    waiting: usize,
    /// `row · columns + column`, upper triangle.
    sums: Vec<Line>,
    arch: Arch,
}

impl ColumnProducts {
    /// No rows yet, for rows of `columns` numbers.
    pub fn new(columns: usize) -> Self {
        let (held, sums) = (vec![Line::ZERO; columns * DEPTH], vec![Line::ZERO; columns * columns]);
        Self { columns, held, waiting: 0, sums, arch: Arch::new() }
    }

    /// Adds `count` rows, of which `entries(column, rows)` gives those of a column.
    ///
    /// # Panics
    /// If they are fewer than the rows that are asked for.
    pub fn add<I: Iterator<Item = f64>>(&mut self, count: usize, entries: impl Fn(usize, Range<usize>) -> I) {
        let mut done = 0;
        while done < count {
            let taken = (DEPTH * SUMS - self.waiting).min(count - done);
            for (column, lines) in self.held.chunks_exact_mut(DEPTH).enumerate() {
                let mut own = entries(column, done..done + taken);
                let mut next = || own.next().expect("an entry for each row");
                if taken == DEPTH * SUMS {
                    lines.iter_mut().for_each(|line| line.0 = std::array::from_fn(|_| next()));
                } else {
                    let places = lines.iter_mut().flat_map(|line| &mut line.0).skip(self.waiting);
                    places.take(taken).for_each(|place| *place = next());
                }
            }
            self.waiting += taken;
            done += taken;
            if self.waiting == DEPTH * SUMS {
                self.absorb();
            }
        }
    }

    /// `WᵀW`, columns × columns.
    pub fn finish(mut self) -> DMatrix<f64> {
        self.absorb();
        let c = self.columns;
        DMatrix::from_fn(c, c, |i, j| self.sums[i.min(j) * c + i.max(j)].sum())
    }

    /// Rounding errors ε of two columns' lengths by which an entry of `RᵀR` differs from the product of the columns at most, for so many
    /// rows: those of its sums, of the root, and of the columns that have no row there.
    pub fn rounding_errors(rows: usize, columns: usize) -> f64 {
        (rows.div_ceil(DEPTH * SUMS) + DEPTH + SUMS + 2 * columns) as f64
    }

    /// The rows R (r × c, r the number of independent columns) with `RᵀR = WᵀW` up to [`Self::rounding_errors`]: the Cholesky factor with the largest pivot first. `None` where a sum is not finite, or so small that it has no digits.
    pub fn root(self) -> Option<DMatrix<f64>> {
        let arch = self.arch;
        let gram = self.finish();
        let c = gram.ncols();
        if !gram.iter().all(|entry| entry.is_finite()) || !(0..c).all(|j| gram[(j, j)] >= LEAST_SQUARE) {
            return None;
        }
        let lengths: Vec<f64> = (0..c).map(|j| gram[(j, j)].sqrt()).collect();
        // Of columns of unit length: what of each square is left, and the rows so far.
        let (mut left, mut is_done) = (vec![1.0; c], vec![false; c]);
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(c);
        // The first of equals.
        let largest = |left: &[f64], is_done: &[bool]| {
            (0..c).filter(|&j| !is_done[j]).reduce(|best, j| if left[j] > left[best] { j } else { best })
        };
        while let Some(pivot) = largest(&left, &is_done).filter(|&j| left[j] > c as f64 * f64::EPSILON) {
            let column = gram.column(pivot);
            let mut row: Vec<f64> =
                column.iter().zip(&lengths).map(|(entry, length)| entry / lengths[pivot] / length).collect();
            arch.dispatch(|| {
                for before in &rows {
                    let size = before[pivot];
                    row.iter_mut().zip(before).for_each(|(entry, of_before)| *entry -= size * of_before);
                }
            });
            let root = left[pivot].sqrt();
            for j in 0..c {
                row[j] = if is_done[j] { 0.0 } else { row[j] / root };
                left[j] -= row[j] * row[j];
            }
            row[pivot] = root;
            is_done[pivot] = true;
            rows.push(row);
        }
        Some(DMatrix::from_fn(rows.len(), c, |k, j| rows[k][j] * lengths[j]))
    }

    fn absorb(&mut self) {
        let Self { columns, ref mut held, ref mut sums, arch, .. } = *self;
        let runs: Vec<Run> = (0..columns).map(|place| Run { place, lines: 0..DEPTH }).collect();
        // Rows that are not there are zero.
        arch.dispatch(Products { runs: &runs, held, stride: DEPTH, width: columns, sums });
        held.fill(Line::ZERO);
        self.waiting = 0;
    }
}

/// What a column holds.
pub(crate) struct Run {
    pub(crate) place: usize,
    /// From the first to the last line that is not zero.
    pub(crate) lines: Range<usize>,
}

/// Products of all columns with each other, added to the sums.
pub(crate) struct Products<'a> {
    /// Columns that are not zero, ascending.
    pub(crate) runs: &'a [Run],
    /// `place · stride + line`.
    pub(crate) held: &'a [Line],
    pub(crate) stride: usize,
    pub(crate) width: usize,
    /// `row · width + column`, upper triangle.
    pub(crate) sums: &'a mut [Line],
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // As many sums as there are registers for.
        if S::REGISTER_COUNT < 32 { self.all::<S, 2>(simd) } else { self.all::<S, 4>(simd) }
    }
}

impl Products<'_> {
    /// J columns after the other.
    #[inline(always)]
    fn all<S: Simd, const J: usize>(mut self, simd: S) {
        let (groups, rest) = self.runs.as_chunks::<J>();
        for (at, columns) in groups.iter().enumerate() {
            self.columns(simd, &self.runs[..J * (at + 1)], columns);
        }
        for (at, column) in (J * groups.len()..).zip(rest) {
            self.columns(simd, &self.runs[..=at], std::array::from_ref(column));
        }
    }

    /// Products of these columns with all of `rows`.
    #[inline(always)]
    fn columns<S: Simd, const J: usize>(&mut self, simd: S, rows: &[Run], columns: &[Run; J]) {
        let (fours, rest) = rows.as_chunks::<4>();
        for rows in fours {
            self.tile(simd, rows, columns);
        }
        for row in rest {
            self.tile(simd, std::array::from_ref(row), columns);
        }
    }

    #[inline(always)]
    fn tile<S: Simd, const I: usize, const J: usize>(&mut self, simd: S, rows: &[Run; I], columns: &[Run; J]) {
        // Lines that are not zero in a row and in a column.
        let first = |runs: &[Run]| runs.iter().map(|run| run.lines.start).min().unwrap_or(0);
        let end = |runs: &[Run]| runs.iter().map(|run| run.lines.end).max().unwrap_or(0);
        let lines = first(rows).max(first(columns))..end(rows).min(end(columns));
        if lines.is_empty() {
            return;
        }
        let of = |run: &Run| &self.held[run.place * self.stride..][lines.clone()];
        let a: [_; I] = std::array::from_fn(|x| of(&rows[x]));
        let b: [_; J] = std::array::from_fn(|y| of(&columns[y]));
        for v in 0..SUMS / S::F64_LANES {
            let mut sums = [[simd.splat_f64s(0.0); J]; I];
            for line in 0..lines.len() {
                let mut right = [simd.splat_f64s(0.0); J];
                for y in 0..J {
                    right[y] = S::as_simd_f64s(&b[y][line].0).0[v];
                }
                for x in 0..I {
                    let left = S::as_simd_f64s(&a[x][line].0).0[v];
                    for y in 0..J {
                        sums[x][y] = simd.add_f64s(sums[x][y], simd.mul_f64s(left, right[y]));
                    }
                }
            }
            for x in 0..I {
                for y in 0..J {
                    let sum = &mut self.sums[rows[x].place * self.width + columns[y].place].0;
                    let to = &mut S::as_mut_simd_f64s(sum).0[v];
                    *to = simd.add_f64s(*to, sums[x][y]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::RowFactor;
    use crate::seed::Seed;
    use rand::RngExt;

    fn random(rows: usize, columns: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(2).stream("column products", run);
        DMatrix::from_fn(rows, columns, |_, j| libm::pow(10.0, (j % 7) as f64 - 3.0) * rng.random_range(-1.0..1.0))
    }

    fn of(w: &DMatrix<f64>, parts: &[usize]) -> ColumnProducts {
        let mut products = ColumnProducts::new(w.ncols());
        let mut first = 0;
        for &count in parts {
            products.add(count, |column, rows| rows.map(move |row| w[(first + row, column)]));
            first += count;
        }
        assert_eq!(first, w.nrows());
        products
    }

    #[test]
    fn identity_the_root_holds_the_products_that_the_factor_does() {
        for (rows, columns) in [(1, 1), (9, 5), (130, 4), (400, 37)] {
            let mut w = random(rows, columns, rows as u64);
            // A dependent column, as of a link that two joints with parallel axes turn.
            if columns > 4 {
                let sum = w.column(1) * 2.0 + w.column(2);
                w.set_column(4, &sum);
            }
            let mut factor = RowFactor::new(columns);
            factor.add(rows, |row, column| w[(row, column)]);
            let (found, factor) = (of(&w, &[rows]).root().unwrap(), factor.finish());
            assert!(found.nrows() <= columns - usize::from(columns > 4));
            let (found, expected) = (found.tr_mul(&found), factor.tr_mul(&factor));
            for i in 0..columns {
                for j in 0..columns {
                    let size = w.column(i).norm() * w.column(j).norm();
                    assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-13 * size, "{rows} × {columns}: {i} {j}");
                }
            }
        }
    }

    #[test]
    fn identity_neither_parts_nor_the_width_of_the_processor_change_a_bit() {
        let w = random(300, 21, 1);
        let whole = of(&w, &[300]);
        assert_eq!(of(&w, &[1, 127, 128, 7, 37]).finish(), whole.clone().finish());
        let mut narrow = ColumnProducts { arch: Arch::Scalar, ..ColumnProducts::new(21) };
        narrow.add(300, |column, rows| w.as_slice()[300 * column..][rows].iter().copied());
        assert_eq!(narrow.root(), whole.root());
    }

    #[test]
    fn identity_the_width_of_the_processor_changes_no_bit_of_columns_that_begin_and_end_apart() {
        let line = |k: usize| Line(std::array::from_fn(|lane| libm::sin((k * k + lane) as f64)));
        let runs: Vec<Run> = (0..38).map(|place| Run { place, lines: place % 3..(place % 4 + 1) * 8 }).collect();
        // A run is all that is not zero: how many columns make a tile is for the processor to say.
        let own = |k: usize| if runs[k / 32].lines.contains(&(k % 32)) { line(k) } else { Line::ZERO };
        let held: Vec<Line> = (0..38 * 32).map(own).collect();
        let [mut wide, mut narrow] = [0, 1].map(|_| vec![Line::ZERO; 38 * 38]);
        Arch::new().dispatch(Products { runs: &runs, held: &held, stride: 32, width: 38, sums: &mut wide });
        Arch::Scalar.dispatch(Products { runs: &runs, held: &held, stride: 32, width: 38, sums: &mut narrow });
        for row in 0..38 {
            for at in 38 * row + row..38 * (row + 1) {
                assert_eq!(wide[at].0, narrow[at].0, "row {row}");
            }
        }
    }

    #[test]
    fn numbers_that_are_none_or_vanish_have_no_root() {
        for bad in [f64::NAN, f64::INFINITY, 1e200] {
            let mut w = random(20, 3, 2);
            w[(7, 1)] = bad;
            assert!(of(&w, &[20]).root().is_none(), "{bad}");
        }
        let mut w = random(20, 3, 2);
        w.column_mut(1).scale_mut(1e-150);
        assert!(of(&w, &[20]).root().is_none());
    }
}
