//! D-optimality: the volume of the estimate's confidence ellipsoid.

use nalgebra::DMatrix;

use super::definition::{Criterion, Score};

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
        let Some(factor) = m.clone().cholesky() else {
            if let Some(s) = sensitivity {
                s.fill(0.0);
            }
            return Score::exact(f64::INFINITY);
        };
        let value = -2.0 * factor.l_dirty().diagonal().iter().map(|l| libm::log(*l)).sum::<f64>();
        if let Some(s) = sensitivity {
            let inverse = factor.inverse();
            for j in 0..m.ncols() {
                for i in 0..=j {
                    let entry = -0.5 * (inverse[(i, j)] + inverse[(j, i)]);
                    s[(i, j)] = entry;
                    s[(j, i)] = entry;
                }
            }
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
