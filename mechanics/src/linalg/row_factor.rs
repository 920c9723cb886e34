//! The triangular factor of rows that come one after another.
//!
//! ```text
//! [ R  ]       [ R' ]
//! [ W₁ ]  = Q₁ [ 0  ]        then W₂ below R', and so on:        WᵀW = RᵀR
//! ```
//! Householder reflections of 32 rows at a time against the factor so far (the sequential form of the tall-skinny QR), so that
//! a matrix of any height is read once and never copied, and its factor is as accurate as that of the whole. The blocks are
//! counted from the first row, and sums run over rows in order: the bits depend neither on how rows were handed over nor on
//! the width of the processor, whose lanes hold columns.
//!
//! Reference: J. Demmel, L. Grigori, M. Hoemmen, J. Langou, "Communication-optimal parallel and sequential QR and LU
//! factorizations", SIAM J. Sci. Comput. 34(1), 2012, sec. 4.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Rows that are reflected at once: with the row of the factor they belong to they stay in the first cache.
const BLOCK: usize = 32;
/// Rows are filled up with zeros to whole vectors of the widest processor.
const VECTOR: usize = 8;
/// Sums of squares below this are taken for zero: their reflection would divide by a product that vanishes.
const LEAST_SQUARE: f64 = 1e-290;

/// The upper triangular factor R of a matrix that comes in rows.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::RowFactor;
/// let mut factor = RowFactor::new(2);
/// factor.add(3, |row, column| [[3.0, 1.0], [0.0, 2.0], [4.0, 1.0]][row][column]);
/// let r = factor.finish();
/// assert!((r[(0, 0)].abs() - 5.0).abs() < 1e-15 && r[(1, 0)] == 0.0);
/// ```
#[derive(Clone, Debug)]
pub struct RowFactor {
    columns: usize,
    /// Length of a row in memory.
    stride: usize,
    /// R by rows; what stands left of the diagonal means nothing.
    factor: Vec<f64>,
    /// Rows that wait, from `start` on, where the first is at the beginning of a cache line.
    block: Vec<f64>,
    start: usize,
    waiting: usize,
    arch: Arch,
}

impl RowFactor {
    /// No rows yet, for rows of `columns` numbers.
    pub fn new(columns: usize) -> Self {
        let stride = columns.next_multiple_of(VECTOR);
        let block = vec![0.0; BLOCK * stride + VECTOR];
        let start = block.as_ptr().align_offset(VECTOR * size_of::<f64>()).min(VECTOR);
        Self { columns, stride, factor: vec![0.0; columns * stride], block, start, waiting: 0, arch: Arch::new() }
    }

    /// Adds `count` rows, whose entries `entry(row, column)` gives.
    pub fn add(&mut self, count: usize, mut entry: impl FnMut(usize, usize) -> f64) {
        let (stride, mut done) = (self.stride, 0);
        while done < count {
            let taken = (BLOCK - self.waiting).min(count - done);
            let rows = &mut self.block[self.start + self.waiting * stride..][..taken * stride];
            for column in 0..self.columns {
                for (row, line) in rows.chunks_exact_mut(stride).enumerate() {
                    line[column] = entry(done + row, column);
                }
            }
            self.waiting += taken;
            done += taken;
            if self.waiting == BLOCK {
                self.absorb();
            }
        }
    }

    /// R, columns × columns. Fewer rows than columns leave zeros below.
    pub fn finish(mut self) -> DMatrix<f64> {
        self.absorb();
        let b = self.columns;
        DMatrix::from_fn(b, b, |i, j| if i <= j { self.factor[i * self.stride + j] } else { 0.0 })
    }

    fn absorb(&mut self) {
        let Self { columns, stride, ref mut factor, ref mut block, start, waiting, arch } = *self;
        let block = &mut block[start..][..waiting * stride];
        arch.dispatch(Absorb { columns, stride, factor, block });
        self.waiting = 0;
    }
}

/// One block of rows against the factor.
struct Absorb<'a> {
    columns: usize,
    stride: usize,
    factor: &'a mut [f64],
    block: &'a mut [f64],
}

/// `1 − s v vᵀ` with `v = (head, tail)`.
struct Reflection<'a> {
    head: f64,
    tail: &'a [f64],
    s: f64,
}

impl WithSimd for Absorb<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, stride, factor, block } = self;
        let mut tail = [0.0; BLOCK];
        for k in 0..columns {
            let (mut squares, mut rows) = ([0.0; 4], 0);
            for (line, tail) in block.chunks_exact(stride).zip(&mut tail) {
                *tail = line[k];
                squares[rows % 4] += line[k] * line[k];
                rows += 1;
            }
            let below = (squares[0] + squares[2]) + (squares[1] + squares[3]);
            let row = &mut factor[k * stride..][..stride];
            let diagonal = row[k];
            let square = diagonal * diagonal + below;
            // Nothing to do, as for the leading zeros of a joint's rows. Not so for NaN, which has to be seen in R.
            if below == 0.0 || square < LEAST_SQUARE {
                continue;
            }
            // The sign that avoids cancellation. vᵀv = −2 · image · head.
            let image = if diagonal > 0.0 { -square.sqrt() } else { square.sqrt() };
            let head = diagonal - image;
            let reflection = Reflection { head, tail: &tail[..rows], s: -1.0 / (image * head) };
            {
                let (row, lines) = (S::as_mut_simd_f64s(row).0, S::as_mut_simd_f64s(block).0);
                let vectors = row.len();
                let mut at = (k + 1) / S::F64_LANES;
                while at + 8 <= vectors {
                    reflect::<S, 8>(simd, &reflection, row, lines, at);
                    at += 8;
                }
                if at + 4 <= vectors {
                    reflect::<S, 4>(simd, &reflection, row, lines, at);
                    at += 4;
                }
                match vectors - at {
                    3 => reflect::<S, 3>(simd, &reflection, row, lines, at),
                    2 => reflect::<S, 2>(simd, &reflection, row, lines, at),
                    1 => reflect::<S, 1>(simd, &reflection, row, lines, at),
                    _ => {}
                }
            }
            factor[k * stride + k] = image;
        }
    }
}

/// Reflects N vectors of columns from the vector `at` on, of one row of the factor and of all lines of the block.
#[inline(always)]
fn reflect<S: Simd, const N: usize>(
    simd: S,
    reflection: &Reflection<'_>,
    row: &mut [S::f64s],
    lines: &mut [S::f64s],
    at: usize,
) {
    let vectors = row.len();
    let row = &mut row[at..at + N];
    let head = simd.splat_f64s(reflection.head);
    let mut sums = [simd.splat_f64s(0.0); N];
    for n in 0..N {
        sums[n] = simd.mul_f64s(head, row[n]);
    }
    for (line, &v) in lines.chunks_exact(vectors).zip(reflection.tail) {
        let (line, v) = (&line[at..at + N], simd.splat_f64s(v));
        for n in 0..N {
            sums[n] = simd.add_f64s(sums[n], simd.mul_f64s(v, line[n]));
        }
    }
    let s = simd.splat_f64s(reflection.s);
    for n in 0..N {
        sums[n] = simd.mul_f64s(s, sums[n]);
        row[n] = simd.sub_f64s(row[n], simd.mul_f64s(head, sums[n]));
    }
    for (line, &v) in lines.chunks_exact_mut(vectors).zip(reflection.tail) {
        let (line, v) = (&mut line[at..at + N], simd.splat_f64s(v));
        for n in 0..N {
            line[n] = simd.sub_f64s(line[n], simd.mul_f64s(v, sums[n]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::triangular_factor;
    use crate::seed::Seed;
    use rand::RngExt;

    fn random(rows: usize, columns: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(2).stream("row factor", run);
        DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
    }

    fn factor(w: &DMatrix<f64>, parts: &[usize]) -> RowFactor {
        let mut factor = RowFactor::new(w.ncols());
        let mut first = 0;
        for &count in parts {
            factor.add(count, |row, column| w[(first + row, column)]);
            first += count;
        }
        assert_eq!(first, w.nrows());
        factor
    }

    #[test]
    fn identity_factor_is_that_of_the_whole_matrix_but_for_signs() {
        for (rows, columns) in [(1, 1), (5, 9), (31, 4), (33, 7), (200, 37), (500, 59)] {
            let mut w = random(rows, columns, rows as u64);
            for (j, mut column) in w.column_iter_mut().enumerate() {
                column *= libm::pow(10.0, (j % 7) as f64 - 3.0);
            }
            let (found, expected) = (factor(&w, &[rows]).finish(), triangular_factor(&w));
            for i in 0..expected.nrows() {
                let sign = (found[(i, i)] * expected[(i, i)]).signum();
                for j in 0..columns {
                    // Both are the factor of columns changed by rounding, one unit for each of some hundred operations.
                    let length = w.column(j).norm();
                    assert!(
                        (found[(i, j)] - sign * expected[(i, j)]).abs() < 1e-12 * length,
                        "{rows} × {columns}: {i} {j}"
                    );
                }
            }
        }
    }

    #[test]
    fn identity_neither_parts_nor_the_width_of_the_processor_change_a_bit() {
        let w = random(150, 21, 1);
        let whole = factor(&w, &[150]).finish();
        assert_eq!(factor(&w, &[1, 31, 32, 7, 79]).finish(), whole);
        let mut narrow = RowFactor { arch: Arch::Scalar, ..RowFactor::new(21) };
        narrow.add(150, |row, column| w[(row, column)]);
        assert_eq!(narrow.finish(), whole);
    }

    #[test]
    fn analytic_an_ill_conditioned_matrix_keeps_its_small_direction() {
        // Columns that differ by 1e-9 of their length: the Gram matrix has lost it, the factor has seven digits of it.
        let (a, d) = (random(400, 1, 3), random(400, 1, 4));
        let w = DMatrix::from_columns(&[a.column(0).into_owned(), (&a + &d * 1e-9).column(0).into_owned()]);
        let rest = &d - &a * (a.dot(&d) / a.norm_squared());
        let r = factor(&w, &[400]).finish();
        assert!((r[(1, 1)].abs() / (1e-9 * rest.norm()) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn leading_zeros_and_numbers_that_are_none_are_seen() {
        let mut w = random(64, 5, 5);
        w.columns_mut(0, 2).fill(0.0);
        let r = factor(&w, &[64]).finish();
        assert_eq!((r[(0, 0)], r[(1, 1)]), (0.0, 0.0));
        assert!((r.tr_mul(&r) - w.tr_mul(&w)).norm() < 1e-13);
        w[(40, 3)] = f64::NAN;
        assert!(factor(&w, &[64]).finish().iter().any(|x| !x.is_finite()));
    }
}
