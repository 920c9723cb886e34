//! Vectors and rotations of expressions.

use nalgebra::{Matrix3, Vector3};

use super::expression::{Expressions, Id};

/// Three expressions.
pub(super) type Triple = [Id; 3];

impl Expressions {
    pub(super) fn vector(&mut self, v: &Vector3<f64>) -> Triple {
        [v.x, v.y, v.z].map(|x| self.number(x))
    }

    /// The rows of a matrix of numbers.
    pub(super) fn matrix(&mut self, m: &Matrix3<f64>) -> [Triple; 3] {
        [0, 1, 2].map(|r| [0, 1, 2].map(|c| self.number(m[(r, c)])))
    }

    pub(super) fn add(&mut self, a: &Triple, b: &Triple) -> Triple {
        [0, 1, 2].map(|i| self.sum(a[i], b[i]))
    }

    pub(super) fn scaled(&mut self, a: &Triple, s: Id) -> Triple {
        a.map(|a| self.product(a, s))
    }

    pub(super) fn dot(&mut self, a: &Triple, b: &Triple) -> Id {
        let parts = [0, 1, 2].map(|i| self.product(a[i], b[i]));
        let first = self.sum(parts[0], parts[1]);
        self.sum(first, parts[2])
    }

    pub(super) fn cross(&mut self, a: &Triple, b: &Triple) -> Triple {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
            let (plus, minus) = (self.product(a[i], b[j]), self.product(a[j], b[i]));
            self.difference(plus, minus)
        })
    }

    /// `M v`.
    pub(super) fn times(&mut self, m: &[Triple; 3], v: &Triple) -> Triple {
        [0, 1, 2].map(|r| self.dot(&m[r], v))
    }

    /// `Mᵀ v`.
    pub(super) fn transposed_times(&mut self, m: &[Triple; 3], v: &Triple) -> Triple {
        [0, 1, 2].map(|c| self.dot(&[m[0][c], m[1][c], m[2][c]], v))
    }

    /// `A B`.
    pub(super) fn composed(&mut self, a: &[Triple; 3], b: &[Triple; 3]) -> [Triple; 3] {
        [0, 1, 2].map(|r| [0, 1, 2].map(|c| self.dot(&a[r], &[b[0][c], b[1][c], b[2][c]])))
    }
}
