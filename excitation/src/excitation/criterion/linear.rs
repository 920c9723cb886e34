//! L-optimality: the variance of chosen combinations of parameters.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::i_optimal::IOptimal;

/// `ln tr(A M⁻¹)` for a declared A, b × b and not negative: the sum of the variances of `L β̂` with `A = LᵀL`.
///
/// It is for an estimate of which a few combinations are asked, whatever becomes of the others. Reference: V. V. Fedorov, *Theory of
/// Optimal Experiments*, 1972, section 2.10.
#[derive(Clone, Debug)]
pub struct LinearOptimal(IOptimal);

impl LinearOptimal {
    /// Of this A.
    pub const fn new(form: DMatrix<f64>) -> Self {
        Self(IOptimal::new(form))
    }
}

impl Criterion for LinearOptimal {
    fn name(&self) -> &'static str {
        "l-optimal"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        self.0.evaluate(m, sensitivity)
    }

    fn is_weighted(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn identity_the_value_of_one_parameter_is_its_variance() {
        let mut rng = Seed::new(64).stream("rows", 0);
        let w = DMatrix::from_fn(40, 5, |_, _| rng.random_range(-1.0..1.0));
        let m = w.tr_mul(&w);
        let mut form = DMatrix::zeros(5, 5);
        form[(3, 3)] = 4.0;
        let criterion = LinearOptimal::new(form);
        let mut s = DMatrix::zeros(5, 5);
        let value = criterion.evaluate(&m, Some(&mut s)).value;
        // By the Schur complement of the other parameters.
        let others = [0, 1, 2, 4];
        let rest = DMatrix::from_fn(4, 4, |i, j| m[(others[i], others[j])]);
        let across = DMatrix::from_fn(4, 1, |i, _| m[(others[i], 3)]);
        let information = m[(3, 3)] - (across.transpose() * rest.try_inverse().unwrap() * &across)[(0, 0)];
        assert!((libm::exp(value) - 4.0 / information).abs() < 1e-12);
        // The value falls by h where the information grows by a factor of 1 + h.
        assert!((s.component_mul(&m).sum() + 1.0).abs() < 1e-12);
        assert!(criterion.is_weighted() && !criterion.asks_for_prediction());
    }
}
