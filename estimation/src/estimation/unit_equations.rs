//! Weighted equations in units in which no unit matters.
//!
//! ```text
//! h = Σ^{-½} W S        z = Σ^{-½} y        γ = S⁻¹ β        S diagonal, each column of h of length 1
//! ```

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::linear_fit::LinearFit;
use super::observation::Observation;

/// Equations `z = h γ + ν` with cov ν = 1.
pub(super) struct UnitEquations {
    /// (n·M) × b.
    pub(super) h: DMatrix<f64>,
    /// n·M.
    pub(super) z: DVector<f64>,
    /// S, b.
    pub(super) scale: DVector<f64>,
}

impl UnitEquations {
    /// With the weights of a weighted fit.
    pub(super) fn of(observation: &Observation, linear: &LinearFit) -> Result<Self, EstimationError> {
        let Some(weights) = &linear.weights else { return Err(EstimationError::NotDefinite) };
        let mut h = weights.clone().whiten(&observation.regressor, &observation.used)?;
        let z = observation.white(weights, &observation.y)?;
        let scale = DVector::from_fn(h.ncols(), |j, _| 1.0 / h.column(j).norm());
        for (j, mut column) in h.column_iter_mut().enumerate() {
            column *= scale[j];
        }
        Ok(Self { h, z, scale })
    }
}
