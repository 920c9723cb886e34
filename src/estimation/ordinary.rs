//! Ordinary least squares.
//!
//! ```text
//! β̂ = (WᵀW)⁻¹ Wᵀ y        cov β̂ = (WᵀW)⁻¹ Wᵀ C W (WᵀW)⁻¹
//! ```
//! Every joint's residual counts the same in N·m, at any noise. Unbiased where the states are exact; its
//! covariance is that of the measured noise, not of an assumed equal one.

use super::{
    Estimate, EstimationError, EstimationProblem, Estimator, Inference, Instruments, IntervalBasis, Termination,
    residual_noise, scatter_noise,
};

/// Ordinary least squares on the base columns.
#[derive(Clone, Copy, Debug, Default)]
pub struct OrdinaryLeastSquares;

impl Estimator for OrdinaryLeastSquares {
    fn name(&self) -> &'static str {
        "ols"
    }

    fn summary(&self) -> &'static str {
        "ordinary least squares: every joint's residual counts the same"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let (observation, equations) = (problem.observation, problem.factorised()?);
        let problem = problem.with_factorisation(&equations);
        let fit = equations.least_squares()?;
        let (noise, basis) = match scatter_noise(observation) {
            Some(noise) => (noise, IntervalBasis::Scatter),
            None => (residual_noise(observation, &observation.residual(fit.solution())), IntervalBasis::Residual),
        };
        Inference {
            estimator: self.name(),
            problem: &problem,
            fit,
            instruments: Instruments::Regressor,
            noise: &noise,
            basis,
            termination: Termination::Direct,
        }
        .estimate()
    }
}
