//! The mass matrix as a product of triangles, from the tip to the base.

use armid::lanes::Lane;

/// `H = U D Uᵀ`: `U` with ones on the diagonal and zeros below it, and the reciprocals of `D`.
///
/// Row i needs the rows of the joints after it alone, so a sweep that goes inwards can factor each row as it finds it
/// (R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, section 6.5, in the same order).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factor<const N: usize, V> {
    upper: [[V; N]; N],
    reciprocal: [V; N],
}

impl<const N: usize> Factor<N, f64> {
    /// Whether the matrix is positive definite.
    pub(crate) fn is_positive(&self) -> bool {
        self.reciprocal.iter().all(|d| d.is_finite() && *d > 0.0)
    }

    /// `H⁻¹ X` in place, X of N rows of `d` numbers.
    #[inline(always)]
    pub(crate) fn solve_rows(&self, x: &mut [f64], d: usize) {
        for j in (0..N).rev() {
            let (own, after) = x[j * d..].split_at_mut(d);
            for k in (j + 1..N).rev() {
                let upper = self.upper[j][k];
                for (own, after) in own.iter_mut().zip(&after[(k - j - 1) * d..(k - j) * d]) {
                    *own -= upper * after;
                }
            }
        }
        for j in 0..N {
            let (before, own) = x.split_at_mut(j * d);
            for own in &mut own[..d] {
                *own *= self.reciprocal[j];
            }
            for k in 0..j {
                let upper = self.upper[k][j];
                for (own, before) in own[..d].iter_mut().zip(&before[k * d..(k + 1) * d]) {
                    *own -= upper * before;
                }
            }
        }
    }
}

impl<const N: usize, V: Lane> Factor<N, V> {
    /// Before any row is taken.
    #[inline(always)]
    pub(crate) fn nothing(zero: V) -> Self {
        Self { upper: [[zero; N]; N], reciprocal: [zero; N] }
    }

    /// Takes row i of a symmetric positive definite matrix, of which the diagonal and what is after it are read, and leaves there that of
    /// `U D`. Rows come from the last to the first.
    #[inline(always)]
    pub(crate) fn take_row(&mut self, i: usize, row: &mut [V; N]) {
        let mut d = row[i];
        for k in (i + 1..N).rev() {
            let mut x = row[k];
            for l in (k + 1..N).rev() {
                x = x - row[l] * self.upper[k][l];
            }
            row[k] = x;
            self.upper[i][k] = x * self.reciprocal[k];
            d = d - x * self.upper[i][k];
        }
        self.reciprocal[i] = d.reciprocal();
    }

    /// Returns this factor in other numbers.
    #[inline(always)]
    pub(crate) fn map<U: Copy>(&self, of: impl Fn(V) -> U) -> Factor<N, U> {
        Factor {
            upper: std::array::from_fn(|i| std::array::from_fn(|j| of(self.upper[i][j]))),
            reciprocal: std::array::from_fn(|i| of(self.reciprocal[i])),
        }
    }

    /// `H⁻¹ = Wᵀ D⁻¹ W` into `w`, with `W = U⁻¹`, a triangle as U is.
    #[inline(always)]
    pub(crate) fn inverse(&self, w: &mut [[V; N]; N]) {
        for i in 0..N {
            for j in i + 1..N {
                w[i][j] = self.upper[i][j];
            }
        }
        for j in 1..N {
            for i in (0..j).rev() {
                let mut sum = self.upper[i][j];
                for k in i + 1..j {
                    sum = sum + self.upper[i][k] * w[k][j];
                }
                w[i][j] = -sum;
            }
        }
        // From the last row on, so that those above it are still those of W.
        for i in (0..N).rev() {
            for j in i..N {
                // The last of the sum has a one of W's diagonal.
                let mut sum = if i == j { self.reciprocal[i] } else { self.reciprocal[i] * w[i][j] };
                for k in 0..i {
                    sum = sum + w[k][i] * self.reciprocal[k] * w[k][j];
                }
                (w[i][j], w[j][i]) = (sum, sum);
            }
        }
    }

    /// `H⁻¹ x`.
    #[inline(always)]
    pub(crate) fn solve(&self, mut x: [V; N]) -> [V; N] {
        for j in (0..N).rev() {
            for k in (j + 1..N).rev() {
                x[j] = x[j] - self.upper[j][k] * x[k];
            }
        }
        for j in 0..N {
            x[j] = x[j] * self.reciprocal[j];
            for k in 0..j {
                x[j] = x[j] - self.upper[k][j] * x[k];
            }
        }
        x
    }
}
