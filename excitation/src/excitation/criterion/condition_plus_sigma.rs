//! The condition number and the smallest singular value together.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::{Powers, extremes, spectral};

/// `ln( κ + 1/σ_min )` of W_b per row: `κ = √(λ_max/λ_min)`, `σ_min = √λ_min` of M; exact, or with the smooth bounds of
/// both.
///
/// The condition number alone does not see how large the information is; the second term does, in the parameters' own
/// units. Singular values are those of `W_b / √rows`, so the sum does not depend on the number of samples. Reference:
/// C. Pressé, M. Gautier, "New criteria of exciting trajectories for robot identification", IEEE ICRA 1993.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConditionPlusSigma {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
}

impl Criterion for ConditionPlusSigma {
    fn name(&self) -> &'static str {
        "condition-plus-sigma"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        spectral(m, sensitivity, |values, weights| {
            let (low, high) = extremes(values);
            let sum = |kappa: f64, inverse: f64| (kappa + inverse, kappa / (kappa + inverse));
            let (exact, share) = sum((values[high] / values[low]).sqrt(), 1.0 / values[low].sqrt());
            let exact = libm::log(exact);
            let Some(p) = self.sharpness else {
                weights[high] = 0.5 * share / values[high];
                weights[low] -= 0.5 / values[low];
                return Score::exact(exact);
            };
            let powers = Powers::of(values, p);
            let (smooth, share) = sum(libm::exp(powers.log_condition()), libm::exp(0.5 * powers.inverse_smallest()));
            for (i, weight) in weights.iter_mut().enumerate() {
                *weight = 0.5 * (share * powers.high_share(i) - powers.low_share(i)) / values[i];
            }
            Score { value: libm::log(smooth), exact }
        })
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness) }))
    }
}
