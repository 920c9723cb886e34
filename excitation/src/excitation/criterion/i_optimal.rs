//! I-optimality: the variance of predicted torque.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score, fill_symmetric, singular};
use super::prediction::Prediction;

/// `ln tr(G M⁻¹)`, with `S = −M⁻¹ G M⁻¹ / tr(G M⁻¹)`.
///
/// With W_e the rows of the evaluation motions and G their mean square ([`Prediction`]), for M per torque row,
///
/// ```text
/// (1/(n N)) Σ_k tr( Y_b(k) cov β̂ Y_b(k)ᵀ ) = tr(G M⁻¹) / rows
/// ```
/// The number that people read is tr(G M⁻¹), (N·m)²: the mean variance of one joint's predicted torque, times the number of
/// torque rows of the experiment. It depends on neither units nor base, and on what is to be predicted. Without a
/// declared prediction G is 1, and it is A-optimality. Source: G. E. P. Box, N. R. Draper, *JASA* 54(287), 1959: the part of the
/// variance in their integrated mean squared error.
#[derive(Clone, Debug, Default)]
pub struct IOptimal {
    gram: Option<DMatrix<f64>>,
}

impl IOptimal {
    /// The criterion of predictions with this mean square G, b × b.
    pub const fn new(gram: DMatrix<f64>) -> Self {
        Self { gram: Some(gram) }
    }
}

impl Criterion for IOptimal {
    fn name(&self) -> &'static str {
        "i-optimal"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let Some(factor) = m.clone().cholesky() else { return singular(sensitivity) };
        let inverse = factor.inverse();
        let weighted = self.gram.as_ref().map_or_else(|| inverse.clone(), |gram| gram * &inverse);
        let trace = weighted.trace();
        if let Some(s) = sensitivity {
            fill_symmetric(s, &inverse.tr_mul(&weighted), trace);
        }
        Score::exact(libm::log(trace))
    }

    fn is_weighted(&self) -> bool {
        true
    }

    fn asks_for_prediction(&self) -> bool {
        true
    }

    fn for_prediction(&self, prediction: Prediction) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self::new(prediction.gram)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::triangular_factor;
    use crate::seed::Seed;
    use rand::RngExt;

    fn rows(count: usize, run: u64) -> DMatrix<f64> {
        let mut rng = Seed::new(61).stream("rows", run);
        DMatrix::from_fn(count, 6, |_, j| rng.random_range(-1.0..1.0) * (1.0 + j as f64))
    }

    #[test]
    fn identity_the_value_is_the_trace_row_by_row() {
        let (w, evaluated) = (rows(40, 0), rows(25, 1));
        let gram = evaluated.tr_mul(&evaluated) / 25.0;
        let value = IOptimal::new(gram).evaluate(&w.tr_mul(&w), None).value;
        // Another factorisation, of W itself: y (Rᵀ R)⁻¹ yᵀ = ‖R⁻ᵀ yᵀ‖², one evaluation row after the other.
        let factor = triangular_factor(&w).view((0, 0), (6, 6)).into_owned();
        let variance =
            |y: nalgebra::DVector<f64>| factor.tr_solve_upper_triangular(&y).expect("full rank").norm_squared();
        let mean = evaluated.row_iter().map(|y| variance(y.transpose())).sum::<f64>() / 25.0;
        assert!((libm::exp(value) / mean - 1.0).abs() < 1e-12, "{value} {mean}");
    }

    #[test]
    fn identity_with_a_prediction_the_base_does_not_count() {
        let (w, evaluated) = (rows(40, 2), rows(25, 3));
        let mut rng = Seed::new(61).stream("base", 0);
        let turn = DMatrix::from_fn(6, 6, |i, j| f64::from(u8::from(i == j)) + 0.3 * rng.random_range(-1.0..1.0));
        let value = |w: &DMatrix<f64>, evaluated: &DMatrix<f64>| {
            IOptimal::new(evaluated.tr_mul(evaluated)).evaluate(&w.tr_mul(w), None).value
        };
        assert!((value(&w, &evaluated) - value(&(&w * &turn), &(&evaluated * &turn))).abs() < 1e-11);
        // Where it is fitted is where it predicts: the trace is the number of parameters.
        assert!((libm::exp(value(&w, &w)) - 6.0).abs() < 1e-11);
    }
}
