//! A-optimality: the sum of the estimate's variances.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};
use super::i_optimal::IOptimal;

/// `ln tr M⁻¹`, with `S = −M⁻² / tr M⁻¹`.
///
/// The trace adds variances of unlike units, kg² to (kg·m²)², so it depends on the choice of units and on which
/// parameters stand for the base. Its logarithm has the same minimiser and a gradient of ordinary size. Reference:
/// F. Pukelsheim, *Optimal Design of Experiments*, 2006, ch. 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AOptimal;

impl Criterion for AOptimal {
    fn name(&self) -> &'static str {
        "a-optimal"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        IOptimal::default().evaluate(m, sensitivity)
    }

    fn is_weighted(&self) -> bool {
        true
    }
}
