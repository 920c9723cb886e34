//! Products of matrices, every entry summed in one order on every processor.
//!
//! ```text
//! A B      entry by entry Σ_k a_ik b_kj, k ascending; lanes hold rows
//! Aᵀ B     entry by entry in eight running sums over the rows, row k in sum k mod 8; lanes hold those sums
//! ```
//! Tiles keep a few sums in registers while they pass over the rows; they change no order.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Running sums of one entry of Aᵀ B.
const SUMS: usize = 8;
/// Rows from which on a column of C alone is made in parts of as many.
const LONG: usize = 512;
/// Columns of Aᵀ A that are made at once.
const SQUARED: usize = 16;

/// The product A B, (m × k)(k × n), each entry summed over k in ascending order: the same bits on every CPU.
///
/// # Panics
/// If A has not as many columns as B has rows.
pub fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(a.ncols(), b.nrows(), "inner sizes agree");
    let mut c = DMatrix::zeros(a.nrows(), b.ncols());
    add_product(a.as_slice(), b.as_slice(), a.nrows(), c.as_mut_slice());
    c
}

/// `Aᵀ B` for A (m × a) and B (m × b), every entry summed in one fixed order: the same bits on every CPU.
///
/// # Panics
/// If the matrices have not the same number of rows.
pub fn transpose_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(a.nrows(), b.nrows(), "as many rows in both");
    transposed_product(a.as_slice(), b.as_slice(), a.nrows())
}

/// `Aᵀ A` for A (m × a), in the sums of [`transpose_product`], half of which are made.
pub fn column_squares(a: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = a.shape();
    let mut squares = DMatrix::zeros(columns, columns);
    for first in (0..columns).step_by(SQUARED).filter(|_| rows > 0) {
        let end = (first + SQUARED).min(columns);
        let [before, own] = [0, first].map(|from| &a.as_slice()[from * rows..end * rows]);
        squares.view_mut((0, first), (end, end - first)).copy_from(&transposed_product(before, own, rows));
    }
    squares.fill_lower_triangle_with_upper_triangle();
    squares
}

/// `C += A B` by columns: A of `rows` × k, C of `rows` × n, and B k × n.
pub fn add_product(a: &[f64], b: &[f64], rows: usize, c: &mut [f64]) {
    if rows > 0 {
        Arch::new().dispatch(AddProduct { a, b, rows, c });
    }
}

/// `Aᵀ B` by columns of `rows` entries.
pub fn transposed_product(a: &[f64], b: &[f64], rows: usize) -> DMatrix<f64> {
    transposed_product_of_parts(a, b, rows, rows)
}

/// `Aᵀ B` by columns of `rows` entries, each `stride` entries behind the one before.
pub fn transposed_product_of_parts(a: &[f64], b: &[f64], stride: usize, rows: usize) -> DMatrix<f64> {
    let columns = |of: &[f64]| if rows > 0 { of.len().div_ceil(stride) } else { 0 };
    let mut c = DMatrix::zeros(columns(a), columns(b));
    if !c.is_empty() {
        Arch::new().dispatch(TransposedProduct { a, b, stride, rows, c: c.as_mut_slice() });
    }
    c
}

struct AddProduct<'a> {
    a: &'a [f64],
    b: &'a [f64],
    rows: usize,
    c: &'a mut [f64],
}

impl WithSimd for AddProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let columns = self.c.len() / self.rows;
        if columns == 1 && self.rows > LONG {
            self.long_column();
            return;
        }
        let mut j = 0;
        while j + 4 <= columns {
            self.columns::<S, 4>(simd, j);
            j += 4;
        }
        while j < columns {
            self.columns::<S, 1>(simd, j);
            j += 1;
        }
    }
}

impl AddProduct<'_> {
    /// One long column of C, in parts that stay in the first cache while the columns of A pass by, each from its beginning to its end.
    #[inline(always)]
    fn long_column(&mut self) {
        for (part, c) in self.c.chunks_mut(LONG).enumerate() {
            let (length, mut columns) = (c.len(), self.a.chunks_exact(self.rows));
            for b in self.b.chunks(4) {
                let mut next = || &columns.next().unwrap_or_default()[part * LONG..][..length];
                if let &[b0, b1, b2, b3] = b {
                    let (a0, a1, a2, a3) = (next(), next(), next(), next());
                    for (row, c) in c.iter_mut().enumerate() {
                        *c = (((*c + a0[row] * b0) + a1[row] * b1) + a2[row] * b2) + a3[row] * b3;
                    }
                } else {
                    for b in b {
                        c.iter_mut().zip(next()).for_each(|(c, a)| *c += a * b);
                    }
                }
            }
        }
    }

    /// N columns of C from column `j` on.
    #[inline(always)]
    fn columns<S: Simd, const N: usize>(&mut self, simd: S, j: usize) {
        let lanes = S::F64_LANES;
        // Rows beyond whole vectors are those of one that ends with the last row: a part of a vector would cost as much as many whole
        // ones. It is found first, since it shares rows with others, and stored last, where both have the same bits.
        let last = self.rows.checked_sub(lanes).filter(|_| !self.rows.is_multiple_of(lanes));
        let of_last = last.map(|row| self.sums::<S, N, 1>(simd, row, j, lanes));
        let mut row = 0;
        while row + 2 * lanes <= self.rows {
            let sums = self.sums::<S, N, 2>(simd, row, j, 2 * lanes);
            self.store(simd, row, j, 2 * lanes, &sums);
            row += 2 * lanes;
        }
        while row < self.rows && (row + lanes <= self.rows || of_last.is_none()) {
            let count = lanes.min(self.rows - row);
            let sums = self.sums::<S, N, 1>(simd, row, j, count);
            self.store(simd, row, j, count, &sums);
            row += count;
        }
        if let (Some(row), Some(sums)) = (last, of_last) {
            self.store(simd, row, j, lanes, &sums);
        }
    }

    /// N columns by V vectors of rows, of which `count` rows are there.
    #[inline(always)]
    fn sums<S: Simd, const N: usize, const V: usize>(
        &self,
        simd: S,
        row: usize,
        j: usize,
        count: usize,
    ) -> [[S::f64s; V]; N] {
        let rows = self.rows;
        let inner = self.a.len() / rows;
        let mut sums = [[simd.splat_f64s(0.0); V]; N];
        for n in 0..N {
            sums[n] = load::<S, V>(simd, &self.c[(j + n) * rows + row..][..count]);
        }
        for k in 0..inner {
            let a = load::<S, V>(simd, &self.a[k * rows + row..][..count]);
            for n in 0..N {
                let b = simd.splat_f64s(self.b[(j + n) * inner + k]);
                for v in 0..V {
                    sums[n][v] = simd.add_f64s(sums[n][v], simd.mul_f64s(a[v], b));
                }
            }
        }
        sums
    }

    #[inline(always)]
    fn store<S: Simd, const N: usize, const V: usize>(
        &mut self,
        simd: S,
        row: usize,
        j: usize,
        count: usize,
        sums: &[[S::f64s; V]; N],
    ) {
        for n in 0..N {
            let to = &mut self.c[(j + n) * self.rows + row..][..count];
            if count == V * S::F64_LANES {
                S::as_mut_simd_f64s(to).0.copy_from_slice(&sums[n]);
            } else {
                simd.partial_store_f64s(to, sums[n][0]);
            }
        }
    }
}

/// V vectors, or the beginning of one.
#[inline(always)]
fn load<S: Simd, const V: usize>(simd: S, from: &[f64]) -> [S::f64s; V] {
    let mut vectors = [simd.splat_f64s(0.0); V];
    if from.len() == V * S::F64_LANES {
        vectors.copy_from_slice(S::as_simd_f64s(from).0);
    } else {
        vectors[0] = simd.partial_load_f64s(from);
    }
    vectors
}

struct TransposedProduct<'a> {
    a: &'a [f64],
    b: &'a [f64],
    stride: usize,
    rows: usize,
    c: &'a mut [f64],
}

impl WithSimd for TransposedProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let (m, n) = (self.a.len().div_ceil(self.stride), self.b.len().div_ceil(self.stride));
        let mut j = 0;
        while j < n {
            let pair = j + 2 <= n;
            let mut i = 0;
            while i < m {
                match (pair, i + 4 <= m) {
                    (true, true) => self.tile::<S, 4, 2>(simd, i, j),
                    (false, true) => self.tile::<S, 4, 1>(simd, i, j),
                    (true, false) => self.tile::<S, 1, 2>(simd, i, j),
                    (false, false) => self.tile::<S, 1, 1>(simd, i, j),
                }
                i += if i + 4 <= m { 4 } else { 1 };
            }
            j += if pair { 2 } else { 1 };
        }
    }
}

impl TransposedProduct<'_> {
    /// I × J entries of C. The running sums are added in halves, s_k to s_k+4, then to s_k+2 and s_k+1, as vectors are.
    #[inline(always)]
    fn tile<S: Simd, const I: usize, const J: usize>(&mut self, simd: S, i: usize, j: usize) {
        let m = self.a.len().div_ceil(self.stride);
        let a: [&[f64]; I] = std::array::from_fn(|x| &self.a[(i + x) * self.stride..][..self.rows]);
        let b: [&[f64]; J] = std::array::from_fn(|x| &self.b[(j + x) * self.stride..][..self.rows]);
        let whole = if SUMS / S::F64_LANES > 1 {
            added(simd, Self::half(simd, &a, &b, 0), Self::half(simd, &a, &b, 1))
        } else {
            Self::half(simd, &a, &b, 0)
        };
        for x in 0..I {
            for y in 0..J {
                self.c[(j + y) * m + i + x] = simd.reduce_sum_f64s(whole[x][y]);
            }
        }
    }

    /// Vectors v, v + 2, … of the running sums, added.
    #[inline(always)]
    fn half<S: Simd, const I: usize, const J: usize>(
        simd: S,
        a: &[&[f64]; I],
        b: &[&[f64]; J],
        v: usize,
    ) -> [[S::f64s; J]; I] {
        let quarter = Self::quarter(simd, a, b, v);
        if SUMS / S::F64_LANES > 2 { added(simd, quarter, Self::quarter(simd, a, b, v + 2)) } else { quarter }
    }

    /// Vectors v and v + 4, added.
    #[inline(always)]
    fn quarter<S: Simd, const I: usize, const J: usize>(
        simd: S,
        a: &[&[f64]; I],
        b: &[&[f64]; J],
        v: usize,
    ) -> [[S::f64s; J]; I] {
        let sums = Self::running_sums(simd, a, b, v);
        if SUMS / S::F64_LANES > 4 { added(simd, sums, Self::running_sums(simd, a, b, v + 4)) } else { sums }
    }

    /// Vector v of the running sums of each entry.
    #[inline(always)]
    fn running_sums<S: Simd, const I: usize, const J: usize>(
        simd: S,
        a: &[&[f64]; I],
        b: &[&[f64]; J],
        v: usize,
    ) -> [[S::f64s; J]; I] {
        let (rows, lanes) = (a[0].len(), S::F64_LANES);
        let whole = rows / SUMS * SUMS;
        let a_parts = a.map(|a| S::as_simd_f64s(&a[..whole]).0);
        let b_parts = b.map(|b| S::as_simd_f64s(&b[..whole]).0);
        let mut sums = [[simd.splat_f64s(0.0); J]; I];
        for at in (v..whole / lanes).step_by(SUMS / lanes) {
            for x in 0..I {
                for y in 0..J {
                    sums[x][y] = simd.add_f64s(sums[x][y], simd.mul_f64s(a_parts[x][at], b_parts[y][at]));
                }
            }
        }
        let rest = rows.min(whole + v * lanes)..rows.min(whole + (v + 1) * lanes);
        if !rest.is_empty() {
            let mut right = [simd.splat_f64s(0.0); J];
            for y in 0..J {
                right[y] = simd.partial_load_f64s(&b[y][rest.clone()]);
            }
            for x in 0..I {
                let left = simd.partial_load_f64s(&a[x][rest.clone()]);
                for y in 0..J {
                    sums[x][y] = simd.add_f64s(sums[x][y], simd.mul_f64s(left, right[y]));
                }
            }
        }
        sums
    }
}

#[inline(always)]
fn added<S: Simd, const I: usize, const J: usize>(
    simd: S,
    mut sums: [[S::f64s; J]; I],
    others: [[S::f64s; J]; I],
) -> [[S::f64s; J]; I] {
    for x in 0..I {
        for y in 0..J {
            sums[x][y] = simd.add_f64s(sums[x][y], others[x][y]);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `Σ aᵢ bᵢ` in eight running sums, as they are written.
    fn dot_of_columns(a: &[f64], b: &[f64]) -> f64 {
        let mut sums = [0.0; 8];
        let (a8, a_rest) = a.as_chunks::<8>();
        let (b8, b_rest) = b.as_chunks::<8>();
        for (a, b) in a8.iter().zip(b8) {
            for l in 0..8 {
                sums[l] += a[l] * b[l];
            }
        }
        for (l, (a, b)) in a_rest.iter().zip(b_rest).enumerate() {
            sums[l] += a * b;
        }
        ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]))
    }

    fn sample(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| libm::sin((7 * i * i + 3 * j + 1) as f64))
    }

    #[test]
    fn identity_product_is_the_sum_in_order_to_the_bit() {
        for (m, k, n) in [(5, 7, 3), (64, 9, 6), (37, 20, 11), (1, 1, 1), (3, 0, 2), (1100, 11, 1)] {
            let (a, b) = (sample(m, k), sample(k, n));
            let c = product(&a, &b);
            for i in 0..m {
                for j in 0..n {
                    let expected = (0..k).fold(0.0, |sum, k| sum + a[(i, k)] * b[(k, j)]);
                    assert_eq!(c[(i, j)], expected);
                }
            }
        }
    }

    #[test]
    fn identity_transposed_product_is_that_of_columns_to_the_bit() {
        for (rows, m, n) in [(1, 2, 1), (8, 5, 3), (61, 9, 4), (200, 4, 7), (0, 2, 3)] {
            let (a, b) = (sample(rows, m), sample(rows, n));
            let c = transpose_product(&a, &b);
            for i in 0..c.nrows() {
                for j in 0..c.ncols() {
                    assert_eq!(c[(i, j)], dot_of_columns(a.column(i).as_slice(), b.column(j).as_slice()));
                }
            }
        }
    }

    #[test]
    fn identity_squares_of_columns_are_their_products_to_the_bit() {
        for (rows, columns) in [(1, 2), (61, 9), (21, 37)] {
            let a = sample(rows, columns);
            assert_eq!(column_squares(&a), transpose_product(&a, &a));
        }
        assert_eq!(column_squares(&sample(0, 2)), DMatrix::zeros(2, 2));
    }

    #[test]
    fn identity_the_width_of_the_processor_changes_no_bit() {
        let (a, b, d) = (sample(61, 9), sample(9, 6), sample(61, 5));
        let mut narrow = vec![0.0; 61 * 6];
        Arch::Scalar.dispatch(AddProduct { a: a.as_slice(), b: b.as_slice(), rows: 61, c: &mut narrow });
        assert_eq!(narrow, product(&a, &b).as_slice());
        let (long, one) = (sample(1037, 6), sample(6, 1));
        let mut narrow = vec![0.0; 1037];
        Arch::Scalar.dispatch(AddProduct { a: long.as_slice(), b: one.as_slice(), rows: 1037, c: &mut narrow });
        assert_eq!(narrow, product(&long, &one).as_slice());
        let mut narrow = vec![0.0; 9 * 5];
        let (a, b) = (a.as_slice(), d.as_slice());
        Arch::Scalar.dispatch(TransposedProduct { a, b, stride: 61, rows: 61, c: &mut narrow });
        assert_eq!(narrow, transposed_product(a, b, 61).as_slice());
    }
}
