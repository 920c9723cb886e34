//! E-optimality: the variance of the worst known combination of parameters.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::{Powers, extremes, spectral};

/// `−ln λ_min(M)`, or its smooth upper bound `1/p ln Σ λ_i^−p`, which exceeds it by at most `ln(b)/p`.
///
/// At good trajectories the smallest eigenvalues meet, and the exact form has a kink there, as the condition number; see
/// [`Condition`](super::Condition). It depends on the parameters' units. Reference: F. Pukelsheim, *Optimal Design of
/// Experiments*, 2006, ch. 6.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EOptimal {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
}

impl Criterion for EOptimal {
    fn name(&self) -> &'static str {
        "e-optimal"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        spectral(m, sensitivity, |values, weights| {
            let (low, _) = extremes(values);
            let exact = -libm::log(values[low]);
            let Some(p) = self.sharpness else {
                weights[low] = -1.0 / values[low];
                return Score::exact(exact);
            };
            let powers = Powers::of(values, p);
            for (i, weight) in weights.iter_mut().enumerate() {
                *weight = -powers.low_share(i) / values[i];
            }
            Score { value: powers.inverse_smallest(), exact }
        })
    }

    fn report(&self, value: f64) -> f64 {
        libm::exp(-value)
    }

    fn is_larger_better(&self) -> bool {
        true
    }

    fn is_weighted(&self) -> bool {
        true
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness) }))
    }
}
