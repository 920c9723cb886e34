//! The condition number of W_b.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::{log_condition, log_condition_smooth};

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    sharpness: Option<f64>,
}

impl Condition {
    /// The condition number itself.
    #[must_use]
    pub const fn exact() -> Self {
        Self { sharpness: None }
    }

    /// Its smooth upper bound with sharpness p.
    #[must_use]
    pub const fn smooth(sharpness: f64) -> Self {
        Self { sharpness: Some(sharpness) }
    }
}

impl Criterion for Condition {
    fn name(&self) -> &'static str {
        "condition"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        match self.sharpness {
            None => log_condition(m, sensitivity),
            Some(p) => log_condition_smooth(m, p, sensitivity),
        }
    }

    fn report(&self, value: f64) -> f64 {
        libm::exp(value)
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self::smooth(sharpness)))
    }
}
