//! Weighted least squares, `radkhah2007` eq. 6.
//!
//! ```text
//! β̂ = (WᵀΣ⁻¹W)⁻¹ WᵀΣ⁻¹ y        cov β̂ = (WᵀΣ⁻¹W)⁻¹ for noise that is white in time
//! ```
//! Σ is the n × n covariance of one sample's torque noise between the joints, the same for every sample: from the
//! scatter over periods, or, where nothing was repeated, from the residual of an ordinary fit. The scale of Σ does not
//! matter to β̂. Where the noise is correlated in time, the weights stay those of single samples and the covariance
//! is the sandwich with all lags, so that the error bars are right although the weights are not the best.

use super::linear_fit::LinearFit;
use super::{Estimate, EstimationError, EstimationProblem, Estimator, Termination};

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
        let equations = problem.factorised()?;
        let linear = LinearFit::weighted(&equations)?;
        linear.estimate(self.name(), &problem.with_factorisation(&equations), &linear.fit, Termination::Direct)
    }
}
