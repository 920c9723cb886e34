//! The condition number of W_b with its columns scaled to unit length.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score, singular};
use super::spectrum::log_condition;

/// `ln κ(W_b D)` with D = diag(M)^−½, which does not depend on the parameters' units; exact or smooth as
/// [`Condition`](super::Condition).
///
/// With C = D M D and S_C = ∂value/∂C
///
/// ```text
/// S = D S_C D − diag( (S_C C)_ii / M_ii )
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConditionScaled {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
}

impl Criterion for ConditionScaled {
    fn name(&self) -> &'static str {
        "condition-scaled"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let b = m.nrows();
        if m.diagonal().iter().any(|&x| x.is_nan() || x <= 0.0) {
            return singular(sensitivity);
        }
        let d: Vec<f64> = m.diagonal().iter().map(|x| 1.0 / x.sqrt()).collect();
        let c = DMatrix::from_fn(b, b, |i, j| m[(i, j)] * d[i] * d[j]);
        let Some(s) = sensitivity else { return log_condition(&c, self.sharpness, None) };
        let value = log_condition(&c, self.sharpness, Some(&mut *s));
        for j in 0..b {
            let turned: f64 = s.column(j).iter().zip(c.column(j).iter()).map(|(s, c)| s * c).sum();
            for i in 0..b {
                s[(i, j)] *= d[i] * d[j];
            }
            s[(j, j)] -= turned / m[(j, j)];
        }
        value
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness) }))
    }
}
