//! The upper triangular root of a positive definite matrix.
//!
//! ```text
//! A = U Uᵀ        B ← U⁻¹ B        xᵀ A⁻¹ y = (U⁻¹ x)ᵀ (U⁻¹ y)
//! ```
//! Unlike the lower root, it leaves zeros where a column of B ends with zeros: for a triangular B that is half of the operations.
//! Every entry has its terms subtracted in one order, the last column first: the same bits on every processor.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Columns of B that are divided at once.
const COLUMNS: usize = 4;

/// U, n × n.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::linalg::UpperRoot;
/// use nalgebra::dmatrix;
/// let root = UpperRoot::new(dmatrix![5.0, 4.0; 4.0, 4.0]).unwrap(); // (1 2; 0 2)
/// let mut b = dmatrix![5.0, 1.0; 4.0, 0.0];
/// root.divide(&mut b);
/// assert_eq!(b, dmatrix![1.0, 1.0; 2.0, 0.0]);
/// assert!(UpperRoot::new(dmatrix![1.0, 2.0; 2.0, 1.0]).is_none());
/// ```
#[derive(Clone, Debug)]
pub struct UpperRoot {
    /// What stands below the diagonal means nothing.
    factor: DMatrix<f64>,
}

impl UpperRoot {
    /// The root of a symmetric matrix, of which the upper triangle is read (n³/3 operations); `None` where it is not positive definite.
    pub fn new(a: DMatrix<f64>) -> Option<Self> {
        let (n, mut factor) = (a.nrows(), a);
        Arch::new().dispatch(Root { n, a: factor.as_mut_slice() }).then_some(Self { factor })
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
        let mut sum = DMatrix::from_diagonal_element(n, n, a);
        Arch::new().dispatch(Sum { n, parts, sum: sum.as_mut_slice() });
        Self::new(sum)
    }

    /// `U⁻¹ B` in place of B (n × m).
    ///
    /// # Panics
    /// If B has another number of rows.
    pub fn divide(&self, b: &mut DMatrix<f64>) {
        let n = self.factor.nrows();
        assert_eq!(b.nrows(), n, "as many rows in both");
        Arch::new().dispatch(Divide { n, root: self.factor.as_slice(), b: b.as_mut_slice() });
    }

    /// `U⁻ᵀ x` in place of x (n).
    pub fn divide_transposed(&self, x: &mut [f64]) {
        for (i, column) in self.factor.column_iter().enumerate() {
            let (done, rest) = x.split_at_mut(i);
            let sum: f64 = done.iter().zip(column.iter()).map(|(x, u)| x * u).sum();
            rest[0] = (rest[0] - sum) / column[i];
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
            for (j, (sum, column)) in self.sum.chunks_exact_mut(self.n.max(1)).zip(columns).enumerate() {
                for (sum, entry) in sum[..=j].iter_mut().zip(&column[..=j]) {
                    *sum += size * entry;
                }
            }
        }
    }
}

struct Root<'a> {
    n: usize,
    a: &'a mut [f64],
}

impl WithSimd for Root<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let n = self.n;
        for j in (0..n).rev() {
            let (before, from) = self.a.split_at_mut(j * n);
            let column = &mut from[..=j];
            let root = column[j].sqrt();
            // Not so for NaN either.
            if !(root > 0.0 && root.is_finite()) {
                return false;
            }
            for entry in &mut *column {
                *entry /= root;
            }
            for (l, other) in before.chunks_exact_mut(n).enumerate() {
                let size = column[l];
                for (entry, of_column) in other[..=l].iter_mut().zip(&column[..=l]) {
                    *entry -= size * of_column;
                }
            }
        }
        true
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
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.n;
        if n == 0 {
            return;
        }
        let mut groups = self.b.chunks_exact_mut(COLUMNS * n);
        for group in &mut groups {
            let (first, rest) = group.split_at_mut(n);
            let (second, rest) = rest.split_at_mut(n);
            let (third, fourth) = rest.split_at_mut(n);
            let height = height(first).max(height(second)).max(height(third)).max(height(fourth));
            let mut end = height;
            // Two entries of each column at once, the last first.
            while end >= 2 {
                let (i, before) = (end - 1, end - 2);
                let (u, v) = (&self.root[i * n..][..=i], &self.root[before * n..][..=before]);
                let (a, b, c, d) = (&mut first[..=i], &mut second[..=i], &mut third[..=i], &mut fourth[..=i]);
                let last = [a[i] / u[i], b[i] / u[i], c[i] / u[i], d[i] / u[i]];
                let next = [
                    (a[before] - last[0] * u[before]) / v[before],
                    (b[before] - last[1] * u[before]) / v[before],
                    (c[before] - last[2] * u[before]) / v[before],
                    (d[before] - last[3] * u[before]) / v[before],
                ];
                [a[i], b[i], c[i], d[i]] = last;
                [a[before], b[before], c[before], d[before]] = next;
                let (u, v) = (&u[..before], &v[..before]);
                let (a, b, c, d) = (&mut a[..before], &mut b[..before], &mut c[..before], &mut d[..before]);
                for k in 0..before {
                    a[k] = (a[k] - last[0] * u[k]) - next[0] * v[k];
                    b[k] = (b[k] - last[1] * u[k]) - next[1] * v[k];
                    c[k] = (c[k] - last[2] * u[k]) - next[2] * v[k];
                    d[k] = (d[k] - last[3] * u[k]) - next[3] * v[k];
                }
                end = before;
            }
            if end == 1 {
                for x in [first, second, third, fourth] {
                    x[0] /= self.root[0];
                }
            }
        }
        for column in groups.into_remainder().chunks_exact_mut(n) {
            for i in (0..height(column)).rev() {
                let u = &self.root[i * n..][..=i];
                column[i] /= u[i];
                let size = column[i];
                for (entry, u) in column[..i].iter_mut().zip(u) {
                    *entry -= size * u;
                }
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
        for n in [1, 4, 23] {
            let root = DMatrix::from_fn(n, n, |i, j| libm::sin((3 * i * i + 5 * j + 1) as f64));
            let a = &root * root.transpose() + DMatrix::identity(n, n);
            // The columns of a triangle, and whole ones.
            let b = DMatrix::from_fn(n, n + 2, |i, j| if i <= j { libm::cos((i * i + 7 * j) as f64) } else { 0.0 });
            let (found, mut divided) = (UpperRoot::new(a.clone()).unwrap(), b.clone());
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
            let root_of_sum = UpperRoot::of_sum(n, 0.5, &[(&a, 3.0), (&half, 2.0)]).unwrap().factor;
            let root_of_sum = root_of_sum.upper_triangle();
            assert!((&root_of_sum * root_of_sum.transpose() - &sum).amax() < 1e-12 * sum.amax());
            let (mut narrow, mut of_narrow) = (a, b);
            assert!(Arch::Scalar.dispatch(Root { n, a: narrow.as_mut_slice() }));
            Arch::Scalar.dispatch(Divide { n, root: narrow.as_slice(), b: of_narrow.as_mut_slice() });
            assert_eq!(of_narrow, divided);
        }
    }
}
