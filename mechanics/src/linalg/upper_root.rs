//! The upper triangular root of a positive definite matrix.
//!
//! ```text
//! A = U Uᵀ        B ← U⁻¹ B        xᵀ A⁻¹ y = (U⁻¹ x)ᵀ (U⁻¹ y)
//! ```
//! Unlike the lower root, it leaves zeros where a column of B ends with zeros: for a triangular B that is half of the operations.
//! Every entry has its terms subtracted in one order, the last column first: the same bits on every processor.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Columns of B that are divided at once, and rows of the transpose.
const COLUMNS: usize = 4;

/// Columns have a multiple of so many entries, as many as the widest processors compute together, so that no loop has a rest: what stands beyond
/// their end means nothing.
const BLOCK: usize = 8;

/// U, n × n.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::UpperRoot;
/// use nalgebra::dmatrix;
/// let root = UpperRoot::new(&dmatrix![5.0, 4.0; 4.0, 4.0]).unwrap(); // (1 2; 0 2)
/// let mut b = dmatrix![5.0, 1.0; 4.0, 0.0];
/// root.divide(&mut b);
/// assert_eq!(b, dmatrix![1.0, 1.0; 2.0, 0.0]);
/// assert!(UpperRoot::new(&dmatrix![1.0, 2.0; 2.0, 1.0]).is_none());
/// ```
#[derive(Clone, Debug)]
pub struct UpperRoot {
    n: usize,
    /// By columns of `stride(n)` numbers. What stands below the diagonal means nothing.
    factor: Vec<f64>,
}

/// Numbers of a column of n.
fn stride(n: usize) -> usize {
    n.next_multiple_of(BLOCK)
}

impl UpperRoot {
    /// The root of a symmetric matrix, of which the upper triangle is read (n³/3 operations); `None` where it is not positive definite.
    pub fn new(a: &DMatrix<f64>) -> Option<Self> {
        Self::of_sum(a.nrows(), 0.0, &[(a, 1.0)])
    }

    /// The root of `a 1 + Σ_k v_k A_k` (n × n) for pairs of A_k and v_k, in that order. Each A_k is symmetric, and zero in rows and columns
    /// beyond its own.
    ///
    /// # Panics
    /// If an A_k is not square or larger than n.
    pub fn of_sum(n: usize, a: f64, parts: &[(&DMatrix<f64>, f64)]) -> Option<Self> {
        for (part, _) in parts {
            assert!(part.is_square() && part.nrows() <= n, "parts of at most {n} rows and columns");
        }
        let mut factor = vec![0.0; n * stride(n)];
        for (i, column) in factor.chunks_exact_mut(stride(n).max(1)).enumerate() {
            column[i] = a;
        }
        let arch = Arch::new();
        arch.dispatch(Sum { n, parts, sum: &mut factor });
        arch.dispatch(Root { n, a: &mut factor }).then_some(Self { n, factor })
    }

    /// `U⁻¹ B` in place of B (n × m).
    ///
    /// # Panics
    /// If B has another number of rows.
    pub fn divide(&self, b: &mut DMatrix<f64>) {
        assert_eq!(b.nrows(), self.n, "as many rows in both");
        Arch::new().dispatch(Divide { n: self.n, root: &self.factor, b: b.as_mut_slice() });
    }

    /// `U⁻ᵀ x` in place of x (n).
    ///
    /// # Panics
    /// If x has another length.
    pub fn divide_transposed(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.n, "as many numbers as rows");
        for first in (0..self.n).step_by(COLUMNS) {
            let count = COLUMNS.min(self.n - first);
            // A column beyond the last is that one again, so that four sums always advance together.
            let column = |c: usize| &self.factor[(first + c.min(count - 1)) * stride(self.n)..];
            let columns: [&[f64]; COLUMNS] = std::array::from_fn(|c| &column(c)[..first + COLUMNS.min(count)]);
            let mut sums = [0.0; COLUMNS];
            for (k, x) in x[..first].iter().enumerate() {
                for (sum, column) in sums.iter_mut().zip(columns) {
                    *sum += x * column[k];
                }
            }
            for (c, (sum, column)) in sums.iter().zip(columns).take(count).enumerate() {
                let of_rest = (first..first + c).fold(*sum, |sum, k| sum + x[k] * column[k]);
                x[first + c] = (x[first + c] - of_rest) / column[first + c];
            }
        }
    }
}

/// Adds to upper triangles.
struct Sum<'a> {
    n: usize,
    parts: &'a [(&'a DMatrix<f64>, f64)],
    sum: &'a mut [f64],
}

impl WithSimd for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for &(part, size) in self.parts {
            let columns = part.as_slice().chunks_exact(part.nrows().max(1));
            for (j, (sum, column)) in self.sum.chunks_exact_mut(stride(self.n).max(1)).zip(columns).enumerate() {
                for (sum, entry) in sum[..=j].iter_mut().zip(&column[..=j]) {
                    *sum += size * entry;
                }
            }
        }
    }
}

/// The vectors of a column that hold its first `rows` numbers.
#[inline(always)]
fn vectors<S: Simd>(column: &[f64], rows: usize) -> &[S::f64s] {
    &S::as_simd_f64s(column).0[..rows.div_ceil(S::F64_LANES)]
}

#[inline(always)]
fn vectors_mut<S: Simd>(column: &mut [f64], rows: usize) -> &mut [S::f64s] {
    &mut S::as_mut_simd_f64s(column).0[..rows.div_ceil(S::F64_LANES)]
}

struct Root<'a> {
    n: usize,
    a: &'a mut [f64],
}

impl Root<'_> {
    /// Divides the column with this end by the root of that, unless there is none.
    #[inline(always)]
    fn divide<S: Simd>(simd: S, column: &mut [f64], end: usize) -> bool {
        let root = column[end].sqrt();
        let roots = simd.splat_f64s(root);
        for entries in vectors_mut::<S>(column, end + 1) {
            *entries = simd.div_f64s(*entries, roots);
        }
        // Not so for NaN either.
        root > 0.0 && root.is_finite()
    }
}

impl WithSimd for Root<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let stride = stride(self.n);
        let mut end = self.n;
        // Two columns at once, the last first.
        while end >= 2 {
            let (before, pair) = self.a[..end * stride].split_at_mut((end - 2) * stride);
            let (second, last) = pair.split_at_mut(stride);
            if !Self::divide(simd, last, end - 1) {
                return false;
            }
            let size = simd.splat_f64s(last[end - 2]);
            for (entries, last) in vectors_mut::<S>(second, end - 1).iter_mut().zip(vectors::<S>(last, end - 1)) {
                *entries = simd.sub_f64s(*entries, simd.mul_f64s(size, *last));
            }
            if !Self::divide(simd, second, end - 2) {
                return false;
            }
            for (l, other) in before.chunks_exact_mut(stride).enumerate() {
                let (of_last, of_second) = (simd.splat_f64s(last[l]), simd.splat_f64s(second[l]));
                let pair = vectors::<S>(last, l + 1).iter().zip(vectors::<S>(second, l + 1));
                for (entries, (last, second)) in vectors_mut::<S>(other, l + 1).iter_mut().zip(pair) {
                    let after_last = simd.sub_f64s(*entries, simd.mul_f64s(of_last, *last));
                    *entries = simd.sub_f64s(after_last, simd.mul_f64s(of_second, *second));
                }
            }
            end -= 2;
        }
        end == 0 || Self::divide(simd, &mut self.a[..stride], 0)
    }
}

struct Divide<'a> {
    n: usize,
    root: &'a [f64],
    b: &'a mut [f64],
}

impl WithSimd for Divide<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (n, stride) = (self.n, stride(self.n));
        if n == 0 {
            return;
        }
        // What is left of some columns: entries that are found go to B, so that whole blocks can follow them here.
        let mut left = vec![0.0; COLUMNS * stride];
        for group in self.b.chunks_mut(COLUMNS * n) {
            let mut end = 0;
            for (left, column) in left.chunks_exact_mut(stride).zip(group.chunks_exact(n)) {
                left[..n].copy_from_slice(column);
                end = end.max(height(column));
            }
            let mut found = |i: usize, entries: [f64; COLUMNS]| {
                for (column, entry) in group.chunks_exact_mut(n).zip(entries) {
                    column[i] = entry;
                }
            };
            let (first, rest) = left.split_at_mut(stride);
            let (second, rest) = rest.split_at_mut(stride);
            let (third, fourth) = rest.split_at_mut(stride);
            // Two entries of each column at once, the last first.
            while end >= 2 {
                let (i, before) = (end - 1, end - 2);
                let (u, v) = (&self.root[i * stride..][..stride], &self.root[before * stride..][..stride]);
                let last = [first[i] / u[i], second[i] / u[i], third[i] / u[i], fourth[i] / u[i]];
                let next = [
                    (first[before] - last[0] * u[before]) / v[before],
                    (second[before] - last[1] * u[before]) / v[before],
                    (third[before] - last[2] * u[before]) / v[before],
                    (fourth[before] - last[3] * u[before]) / v[before],
                ];
                found(i, last);
                found(before, next);
                let mut splat = [[simd.splat_f64s(0.0); COLUMNS]; 2];
                for column in 0..COLUMNS {
                    splat[0][column] = simd.splat_f64s(last[column]);
                    splat[1][column] = simd.splat_f64s(next[column]);
                }
                let pair = vectors::<S>(u, before).iter().zip(vectors::<S>(v, before));
                let (a, b) = (vectors_mut::<S>(first, before), vectors_mut::<S>(second, before));
                let (c, d) = (vectors_mut::<S>(third, before), vectors_mut::<S>(fourth, before));
                let columns = a.iter_mut().zip(b).zip(c.iter_mut().zip(d));
                for ((u, v), ((a, b), (c, d))) in pair.zip(columns) {
                    for (column, entries) in [a, b, c, d].into_iter().enumerate() {
                        let after_last = simd.sub_f64s(*entries, simd.mul_f64s(splat[0][column], *u));
                        *entries = simd.sub_f64s(after_last, simd.mul_f64s(splat[1][column], *v));
                    }
                }
                end = before;
            }
            if end == 1 {
                found(0, [first[0], second[0], third[0], fourth[0]].map(|entry| entry / self.root[0]));
            }
        }
    }
}

/// Entries up to the last that is not zero.
#[inline(always)]
fn height(column: &[f64]) -> usize {
    column.iter().rposition(|entry| *entry != 0.0).map_or(0, |last| last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_the_root_times_what_was_divided_is_that_on_every_processor() {
        for n in [1, 4, 16, 23] {
            let root = DMatrix::from_fn(n, n, |i, j| libm::sin((3 * i * i + 5 * j + 1) as f64));
            let a = &root * root.transpose() + DMatrix::identity(n, n);
            // The columns of a triangle, and whole ones.
            let b = DMatrix::from_fn(n, n + 2, |i, j| if i <= j { libm::cos((i * i + 7 * j) as f64) } else { 0.0 });
            let (found, mut divided) = (UpperRoot::new(&a).unwrap(), b.clone());
            found.divide(&mut divided);
            let expected = b.tr_mul(&(a.clone().try_inverse().unwrap() * &b));
            assert!((divided.tr_mul(&divided) - expected).amax() < 1e-12);
            let mut x = divided.column(n).into_owned();
            found.divide_transposed(x.as_mut_slice());
            assert!((&a * x - b.column(n)).amax() < 1e-12);
            let half = a.view((0, 0), (n / 2, n / 2)).into_owned();
            let mut sum = a.clone() * 3.0 + DMatrix::identity(n, n) * 0.5;
            let mut corner = sum.view_mut((0, 0), (n / 2, n / 2));
            corner += &half * 2.0;
            let of_sum = UpperRoot::of_sum(n, 0.5, &[(&a, 3.0), (&half, 2.0)]).unwrap().factor;
            let root_of_sum = DMatrix::from_column_slice(stride(n), n, &of_sum).rows(0, n).upper_triangle();
            assert!((&root_of_sum * root_of_sum.transpose() - &sum).amax() < 1e-12 * sum.amax());
            let (mut narrow, mut of_narrow) = (vec![0.0; n * stride(n)], b);
            Arch::Scalar.dispatch(Sum { n, parts: &[(&a, 1.0)], sum: &mut narrow });
            assert!(Arch::Scalar.dispatch(Root { n, a: &mut narrow }));
            Arch::Scalar.dispatch(Divide { n, root: &narrow, b: of_narrow.as_mut_slice() });
            assert_eq!(of_narrow, divided);
        }
    }
}
