//! The normal equations of a log, block by block, in the coordinates of the search.
//!
//! ```text
//! A_b = Σ_{k in b} Xᵀ W_kᵀ Σ⁻¹ W_k X        g_b = Σ Xᵀ W_kᵀ Σ⁻¹ y_k        s_b = Σ y_kᵀ Σ⁻¹ y_k        φ = X x
//! ```
//! Once they are there, an evaluation costs as much for an hour of motion as for a second.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::linalg::Gram;

/// The sums of one block or several.
#[derive(Clone, Debug)]
pub(super) struct NormalEquations {
    pub(super) information: DMatrix<f64>,
    pub(super) moment: DVector<f64>,
    pub(super) square: f64,
}

impl NormalEquations {
    /// Of some rows of W (nM × p) and y, each with the weight of its joint (n).
    pub(super) fn of(w: &DMatrix<f64>, y: &DVector<f64>, weights: &[f64], rows: Range<usize>) -> Self {
        let mut gram = Gram::new(w.ncols());
        let mut row = vec![0.0; w.ncols()];
        for at in rows {
            row.iter_mut().zip(w.row(at).iter()).for_each(|(to, &value)| *to = value);
            if row.iter().any(|&entry| entry != 0.0) {
                gram.add_row(&row, y[at], weights[at % weights.len()]);
            }
        }
        Self { information: gram.information(), moment: gram.moment, square: gram.energy }
    }

    /// The sums of all of these.
    pub(super) fn sum(blocks: &[Self]) -> Self {
        let mut sum = blocks[0].clone();
        for block in &blocks[1..] {
            sum.information += &block.information;
            sum.moment += &block.moment;
            sum.square += block.square;
        }
        sum
    }

    /// Without one of its blocks.
    pub(super) fn without(&self, block: &Self) -> Self {
        Self {
            information: &self.information - &block.information,
            moment: &self.moment - &block.moment,
            square: self.square - block.square,
        }
    }

    /// By how much rounding may change `½ xᵀ A x − gᵀ x`, whose terms may be far larger than their sum.
    pub(super) fn rounding(&self, x: &DVector<f64>) -> f64 {
        let size = x.abs();
        f64::EPSILON * (size.dot(&(self.information.abs() * &size)) + self.moment.abs().dot(&size))
    }

    /// `Σ (y − W X x)ᵀ Σ⁻¹ (y − W X x)`.
    pub(super) fn misfit(&self, x: &DVector<f64>) -> f64 {
        (self.square - 2.0 * self.moment.dot(x) + x.dot(&(&self.information * x))).max(0.0)
    }
}
