//! Weighted least squares, the paper's eq. 6.
//!
//! ```text
//! β̂ = (WᵀΣ⁻¹W)⁻¹ WᵀΣ⁻¹ y        cov β̂ = (WᵀΣ⁻¹W)⁻¹ for noise that is white in time
//! ```
//! Σ is the n × n covariance of one sample's torque noise between the joints, the same for every sample: from the
//! scatter over periods, or, where nothing was repeated, from the residual of an ordinary fit. The scale of Σ does not
//! matter to β̂. Where the noise is correlated in time, the weights stay those of single samples and the covariance
//! is the sandwich with all lags, so that the error bars are right although the weights are not the best.

use nalgebra::DMatrix;

use super::appraisal::{Appraisal, solve};
use super::residual::residual_noise;
use super::{Estimate, EstimationError, EstimationProblem, Estimator, IntervalBasis, Termination};
use crate::linalg::BlockWhitening;
use crate::signal::NoiseModel;

/// Least squares weighted with the inverse noise covariance of each sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct WeightedLeastSquares;

impl Estimator for WeightedLeastSquares {
    fn name(&self) -> &'static str {
        "wls"
    }

    fn summary(&self) -> &'static str {
        "least squares weighted with the measured noise of each joint"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let observation = problem.observation;
        let b = observation.base.rank();
        let residual = |beta: &nalgebra::DVector<f64>| -> NoiseModel {
            residual_noise(&observation.residual(beta), observation.dof, b, observation.periodic)
        };
        let seen = match &observation.noise {
            Some(noise) => noise.clone(),
            None => residual(solve(observation, &observation.regressor, &observation.y)?.solution()),
        };
        let whitening = BlockWhitening::new(seen.covariance())?;
        let w = whitening.whiten(&observation.regressor)?;
        let y = whitening.whiten(&DMatrix::from_column_slice(observation.y.len(), 1, observation.y.as_slice()))?;
        let fit = solve(observation, &w, &y.column(0).into_owned())?;
        let weighted = whitening.whiten_transposed(&w)?;
        let (noise, basis) = match &observation.noise {
            Some(_) => (seen, IntervalBasis::Scatter),
            None => (residual(fit.solution()), IntervalBasis::Residual),
        };
        Appraisal {
            estimator: self.name(),
            problem,
            fit: &fit,
            weighted: &weighted,
            noise: &noise,
            basis,
            termination: Termination::Direct,
        }
        .estimate()
    }
}
