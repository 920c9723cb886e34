//! Weighted least squares, `radkhah2007` eq. 6.
//!
//! ```text
//! β̂ = (WᵀΣ⁻¹W)⁻¹ WᵀΣ⁻¹ y        cov β̂ = (WᵀΣ⁻¹W)⁻¹ for noise that is white in time
//! ```
//! Σ is the n × n covariance of one sample's torque noise between the joints, the same for every sample: from the
//! scatter over periods, or, where nothing was repeated, from the residual of an ordinary fit. The scale of Σ does not
//! matter to β̂. Where the noise is correlated in time, the weights stay those of single samples and the covariance
//! is the sandwich with all lags, so that the error bars are right although the weights are not the best.

use nalgebra::DMatrix;

use super::{
    Estimate, EstimationError, EstimationProblem, Estimator, Inference, IntervalBasis, Termination, residual_noise,
    scatter_noise, solve,
};
use crate::linalg::BlockWhitening;

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
        let (seen, basis) = match scatter_noise(observation) {
            Some(noise) => (noise, IntervalBasis::Scatter),
            None => {
                let start = solve(observation, &observation.regressor, &observation.y)?;
                (residual_noise(observation, &observation.residual(start.solution())), IntervalBasis::Residual)
            }
        };
        let mut whitening = BlockWhitening::new(seen.covariance())?;
        let w = whitening.whiten(&observation.regressor, &observation.used)?;
        let y = whitening
            .whiten(&DMatrix::from_column_slice(observation.y.len(), 1, observation.y.as_slice()), &observation.used)?;
        let fit = solve(observation, &w, &y.column(0).into_owned())?;
        let weighted = whitening.whiten_transposed(&w, &observation.used)?;
        let noise = match basis {
            IntervalBasis::Scatter => seen,
            IntervalBasis::Residual => residual_noise(observation, &observation.residual(fit.solution())),
        };
        Inference {
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
