//! D-optimality: the volume of the estimate's confidence ellipsoid.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score, fill_symmetric, singular};

/// `−ln det M`, with `S = −M⁻¹`.
///
/// It changes by a constant when parameters are scaled or others stand for the same base, so its minimiser depends on
/// neither. Reference: J. Swevers et al., IEEE T-RA 13(5), 1997, eq. 15; `radkhah2007` II.D for the sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DOptimal;

impl Criterion for DOptimal {
    fn name(&self) -> &'static str {
        "d-optimal"
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let Some(factor) = m.clone().cholesky() else { return singular(sensitivity) };
        let value = -2.0 * factor.l_dirty().diagonal().iter().map(|l| libm::log(*l)).sum::<f64>();
        if let Some(s) = sensitivity {
            fill_symmetric(s, &factor.inverse(), 1.0);
        }
        Score::exact(value)
    }

    fn report(&self, value: f64) -> f64 {
        -value
    }

    fn is_larger_better(&self) -> bool {
        true
    }

    fn is_weighted(&self) -> bool {
        true
    }
}
