//! The condition number and D-optimality together.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::{Powers, extremes, spectral};

/// `κ(W_b) − ln det M` with equal weights, M per row; exact, or with the smooth bound of κ.
///
/// A sum that other tools minimise to have both; what the two terms weigh against each other is left to chance, since
/// one is a ratio and the other a logarithm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConditionPlusD {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
}

impl Criterion for ConditionPlusD {
    fn name(&self) -> &'static str {
        "condition-plus-d"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        spectral(m, sensitivity, |values, weights| {
            let (low, high) = extremes(values);
            let log_det: f64 = values.iter().map(|&x| libm::log(x)).sum();
            let kappa = (values[high] / values[low]).sqrt();
            let exact = kappa - log_det;
            let value = match self.sharpness {
                None => {
                    weights[high] = 0.5 * kappa / values[high];
                    weights[low] -= 0.5 * kappa / values[low];
                    exact
                }
                Some(p) => {
                    let powers = Powers::of(values, p);
                    let kappa = libm::exp(powers.log_condition());
                    for (i, weight) in weights.iter_mut().enumerate() {
                        *weight = 0.5 * kappa * (powers.high_share(i) - powers.low_share(i)) / values[i];
                    }
                    kappa - log_det
                }
            };
            for (weight, value) in weights.iter_mut().zip(values) {
                *weight -= 1.0 / value;
            }
            Score { value, exact }
        })
    }

    fn report(&self, value: f64) -> f64 {
        value
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness) }))
    }
}
