//! One Householder reflection.

use super::dot::dot;

/// `H = 1 − 2 v vᵀ / (vᵀ v)`, acting on the entries from `start` on.
pub(super) struct Reflection {
    start: usize,
    v: Vec<f64>,
    two_over_vv: f64,
}

/// Euclidean length.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

impl Reflection {
    /// The reflection that sends the entries of `column` from `start` on to a multiple of the first of them; the
    /// column is overwritten with its image. The tail must not be zero.
    pub(super) fn annihilate(column: &mut [f64], start: usize) -> Self {
        let mut v = column[start..].to_vec();
        // The sign that avoids cancellation.
        let image = if v[0] > 0.0 { -norm(&v) } else { norm(&v) };
        v[0] -= image;
        column[start] = image;
        column[start + 1..].fill(0.0);
        let two_over_vv = 2.0 / dot(&v, &v);
        Self { start, v, two_over_vv }
    }

    /// Applies the reflection to a column.
    pub(super) fn apply(&self, column: &mut [f64]) {
        let tail = &mut column[self.start..];
        let factor = self.two_over_vv * dot(&self.v, tail);
        for (x, v) in tail.iter_mut().zip(&self.v) {
            *x -= factor * v;
        }
    }
}
