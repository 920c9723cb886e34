//! The condition number of W_b.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::log_condition;

/// `ln κ(W_b) = ½ (ln λ_max − ln λ_min)` of the information M = W_bᵀ W_b, or its smooth upper bound.
///
/// Where extreme eigenvalues cross, ln κ has a kink, and the gradient of one eigenvector says nothing about the other.
/// At good trajectories the smallest eigenvalues always meet. The smooth form weights *all* eigenvectors,
///
/// ```text
/// ln κ_p = 1/(2p) ( ln Σ λ_i^p + ln Σ λ_i^−p ),        ln κ ≤ ln κ_p ≤ ln κ + ln(b)/p
/// ```
/// is as smooth as M itself where eigenvalues cross (it depends on the eigenvalues symmetrically), and is minimised for a
/// growing sharpness p. The exact form has one valid subgradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Condition {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
}

impl Criterion for Condition {
    fn name(&self) -> &'static str {
        "condition"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        log_condition(m, self.sharpness, sensitivity)
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness) }))
    }
}
