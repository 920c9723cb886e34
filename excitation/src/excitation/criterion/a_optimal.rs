//! A-optimality: the sum of the estimate's variances.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};

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
        let Some(factor) = m.clone().cholesky() else {
            if let Some(s) = sensitivity {
                s.fill(0.0);
            }
            return Score::exact(f64::INFINITY);
        };
        let inverse = factor.inverse();
        let trace = inverse.trace();
        if let Some(s) = sensitivity {
            let square = inverse.tr_mul(&inverse);
            for j in 0..m.ncols() {
                for i in 0..=j {
                    let entry = -0.5 * (square[(i, j)] + square[(j, i)]) / trace;
                    s[(i, j)] = entry;
                    s[(j, i)] = entry;
                }
            }
        }
        Score::exact(libm::log(trace))
    }

    fn report(&self, value: f64) -> f64 {
        libm::exp(value)
    }

    fn is_weighted(&self) -> bool {
        true
    }
}
