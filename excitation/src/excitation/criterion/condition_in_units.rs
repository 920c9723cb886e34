//! The condition number of the equations as the estimator weights them, with parameters in declared units.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::spectrum::log_condition;

/// `ln κ(Σ^−½ W_b U)` with U = diag(u) of the declared unit of each base parameter; exact or smooth as
/// [`Condition`](super::Condition).
///
/// With C = U M U and S_C = ∂value/∂C the derivative is S = U S_C U. Until units are told they are SI's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConditionInUnits {
    /// Sharpness p of the smooth bound; the criterion itself where there is none.
    pub sharpness: Option<f64>,
    /// Unit of each parameter, b; all 1 where empty.
    pub units: Vec<f64>,
}

impl ConditionInUnits {
    /// U A U.
    fn scaled(&self, a: &DMatrix<f64>) -> DMatrix<f64> {
        let unit = |i: usize| self.units.get(i).copied().unwrap_or(1.0);
        DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * unit(i) * unit(j))
    }
}

impl Criterion for ConditionInUnits {
    fn name(&self) -> &'static str {
        "condition-in-units"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let c = self.scaled(m);
        let Some(s) = sensitivity else { return log_condition(&c, self.sharpness, None) };
        let value = log_condition(&c, self.sharpness, Some(&mut *s));
        *s = self.scaled(s);
        value
    }

    fn is_weighted(&self) -> bool {
        true
    }

    fn is_monotone(&self) -> bool {
        false
    }

    fn smoothed(&self, sharpness: f64) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { sharpness: Some(sharpness), ..self.clone() }))
    }

    fn in_units(&self, units: &[f64]) -> Option<Box<dyn Criterion>> {
        Some(Box::new(Self { units: units.to_vec(), ..self.clone() }))
    }
}
