//! Eigenvalues and eigenvectors of a symmetric matrix.
//!
//! ```text
//! A = Q T Qᵀ, T tridiagonal        T ← Gᵀ T G, Q ← Q G   until T is diagonal
//! ```
//! The bits are those of nalgebra's `SymmetricEigen`, whose tridiagonal form this takes. Its rotations G of Q, most of the work, are on the
//! processor's vectors here: a search needs eigenvectors of each trial motion.
//!
//! Reference: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., 2013, sec. 8.3.

use nalgebra::linalg::SymmetricTridiagonal;
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};
use pulp::{Arch, Simd, WithSimd};

/// The eigenvalues, in no order, and the eigenvectors of a symmetric matrix, of which the lower triangle is read.
///
/// ```
/// # use armid_mechanics as armid;
/// use nalgebra::dmatrix;
/// let found = armid::linalg::symmetric_eigen(dmatrix![2.0, 1.0; 1.0, 2.0]);
/// assert!((found.eigenvalues.max() - 3.0).abs() < 1e-15 && (found.eigenvalues.min() - 1.0).abs() < 1e-15);
/// ```
///
/// # Panics
/// If the matrix is empty or not square.
pub fn symmetric_eigen(mut a: DMatrix<f64>) -> SymmetricEigen<f64, Dyn> {
    let size = a.amax();
    if size != 0.0 {
        a /= size;
    }
    let (q, diagonal, beside) = SymmetricTridiagonal::new(a).unpack();
    let mut form = Tridiagonal { diagonal, beside, q };
    Arch::new().dispatch(Diagonalise(&mut form));
    SymmetricEigen { eigenvectors: form.q, eigenvalues: form.diagonal * size }
}

/// `A = Q T Qᵀ`.
struct Tridiagonal {
    diagonal: DVector<f64>,
    /// The elements next to the diagonal.
    beside: DVector<f64>,
    q: DMatrix<f64>,
}

impl Tridiagonal {
    /// Whether the element next to the diagonal in row i is more than rounding. One that is not a number is none, so that all ends.
    fn is_joined(&self, i: usize) -> bool {
        self.beside[i].abs() > f64::EPSILON * (self.diagonal[i].abs() + self.diagonal[i + 1].abs())
    }

    /// First and last row of the block to work on next: the last up to row `end` that is not diagonal. Its upper end is cut off from the rest.
    fn block(&mut self, mut end: usize) -> Option<(usize, usize)> {
        while !self.is_joined(end.checked_sub(1)?) {
            end -= 1;
        }
        let mut start = end - 1;
        while start > 0 {
            if !self.is_joined(start - 1) {
                self.beside[start - 1] = 0.0;
                break;
            }
            start -= 1;
        }
        Some((start, end))
    }

    /// One implicit QR step of a block of three rows or more, with Wilkinson's shift.
    #[inline(always)]
    fn step(&mut self, start: usize, end: usize) {
        let (t, beside) = (&mut self.diagonal, &mut self.beside);
        let (mut x, mut y) = (t[start] - shift(t[end - 1], t[end], beside[end - 1]), beside[start]);
        for i in start..end {
            if y == 0.0 {
                break;
            }
            let (c, s, length) = rotation(x, y);
            if i > start {
                beside[i - 1] = length;
            }
            let (cc, ss, cs) = (c * c, s * s, c * s);
            let (upper, lower, between) = (t[i], t[i + 1], beside[i]);
            let twice = cs * 2.0 * between;
            t[i] = (cc * upper + ss * lower) + twice;
            t[i + 1] = (ss * upper + cc * lower) - twice;
            beside[i] = between * (cc - ss) - cs * (upper - lower);
            if i + 1 < end {
                (x, y) = (beside[i], s * beside[i + 1]);
                beside[i + 1] *= c;
            }
            rotate(&mut self.q, i, c, s);
        }
    }

    /// Diagonalises a block of two rows.
    #[inline(always)]
    fn finish_pair(&mut self, start: usize) {
        let (upper, lower, between) = (self.diagonal[start], self.diagonal[start + 1], self.beside[start]);
        let (values, [x, y]) = pair(upper, lower, between);
        [self.diagonal[start], self.diagonal[start + 1]] = values;
        let (c, s, length) = rotation(x, y);
        if length.abs() > f64::EPSILON {
            rotate(&mut self.q, start, c, s);
        }
    }
}

/// Eigenvalues of `[[upper, between], [between, lower]]`, and an eigenvector of the first: of its two forms the one with less cancellation.
#[inline(always)]
fn pair(upper: f64, lower: f64, between: f64) -> ([f64; 2], [f64; 2]) {
    let half = (upper - lower) * 0.5;
    let (middle, root) = ((upper + lower) * 0.5, (between * between + half * half).sqrt());
    let values = [middle + root, middle - root];
    let (from_upper, from_lower) = (values[0] - upper, values[0] - lower);
    let is_lower = from_lower.abs() > from_upper.abs();
    (values, if is_lower { [from_lower, between] } else { [between, from_upper] })
}

/// Wilkinson's: of the eigenvalues of the last two rows that nearer to the last element.
#[inline(always)]
fn shift(upper: f64, lower: f64, between: f64) -> f64 {
    let square = between * between;
    if square == 0.0 {
        return lower;
    }
    let half = (upper - lower) * 0.5;
    lower - square / (half + half.signum() * (half * half + square).sqrt())
}

/// Cosine and sine of the angle of `(x, y)`, between −π/2 and π/2, and its length with the sign of x.
#[inline(always)]
fn rotation(x: f64, y: f64) -> (f64, f64, f64) {
    let length = (x * x + y * y).sqrt();
    let sign = if x >= 0.0 { 1.0 } else { -1.0 };
    (sign * x / length, y / (sign * length), sign * length)
}

/// Turns columns i and i + 1 into each other.
#[inline(always)]
fn rotate(q: &mut DMatrix<f64>, i: usize, c: f64, s: f64) {
    let n = q.nrows();
    let (left, right) = q.as_mut_slice()[i * n..(i + 2) * n].split_at_mut(n);
    let ((lefts, left), (rights, right)) = (left.as_chunks_mut::<4>(), right.as_chunks_mut::<4>());
    for (left, right) in lefts.iter_mut().zip(rights) {
        let (a, b) = (*left, *right);
        *left = std::array::from_fn(|k| a[k] * c + s * b[k]);
        *right = std::array::from_fn(|k| -s * a[k] + b[k] * c);
    }
    for (left, right) in left.iter_mut().zip(right) {
        (*left, *right) = (*left * c + s * *right, -s * *left + *right * c);
    }
}

/// Rotates T until it is diagonal, compiled for the vectors of the processor by their width alone.
struct Diagonalise<'a>(&'a mut Tridiagonal);

impl WithSimd for Diagonalise<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let form = self.0;
        let mut last = form.diagonal.len() - 1;
        while let Some((start, end)) = form.block(last) {
            last = end;
            if end - start == 1 {
                form.finish_pair(start);
                last -= 1;
            } else {
                form.step(start, end);
                if !form.is_joined(end - 1) {
                    last -= 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    /// Of random eigenvalues, of few that repeat, in blocks, and of all sizes.
    #[test]
    fn published_the_bits_are_nalgebras_and_the_matrix_comes_back() {
        for run in 0..120 {
            let n = 1 + usize::try_from(run % 40).unwrap();
            let mut rng = Seed::new(31).stream("eigen", run);
            let mut a = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
            match run % 4 {
                0 => a = &a * a.transpose(),
                1 => (0..n).for_each(|i| a[(i, i)] = 1e6 * f64::from(i as u32 % 3)),
                2 => a = DMatrix::from_fn(n, n, |r, c| if r / 3 == c / 3 { a[(r, c)] } else { 0.0 }),
                _ => {}
            }
            a = (&a + a.transpose()) * 0.5;
            let (found, expected) = (symmetric_eigen(a.clone()), SymmetricEigen::new(a.clone()));
            assert_eq!(found.eigenvalues, expected.eigenvalues, "run {run}");
            assert_eq!(found.eigenvectors, expected.eigenvectors, "run {run}");
            assert!((found.recompose() - &a).amax() <= 1e-13 * n as f64 * a.amax(), "run {run}");
        }
        assert_eq!(symmetric_eigen(DMatrix::zeros(3, 3)).eigenvalues, DVector::zeros(3));
        // It ends, whatever the numbers.
        for bad in [f64::NAN, f64::INFINITY] {
            let mut a = DMatrix::from_element(5, 5, 1.0);
            a[(3, 1)] = bad;
            assert!(symmetric_eigen(a).eigenvalues.iter().any(|value| !value.is_finite()));
        }
    }
}
