//! The linear fit that other estimators begin with: ordinary or weighted, with the noise behind its error bars.

use super::error::EstimationError;
use super::estimate::{Estimate, IntervalBasis};
use super::factorisation::Factorisation;
use super::inference::Inference;
use super::instruments::Instruments;
use super::observation::Observation;
use super::problem::EstimationProblem;
use super::residual::{residual_noise, scatter_noise};
use super::termination::Termination;
use crate::linalg::{BlockWhitening, LeastSquares};
use crate::signal::NoiseModel;

/// The noise of the equations of a fit: scatter over periods where there is one, else that of its residual.
pub(super) fn noise_of(observation: &Observation, fit: &LeastSquares) -> (NoiseModel, IntervalBasis) {
    match scatter_noise(observation) {
        Some(noise) => (noise, IntervalBasis::Scatter),
        None => (residual_noise(observation, &observation.residual(fit.solution())), IntervalBasis::Residual),
    }
}

/// A least-squares fit, ordinary where there are no weights.
#[derive(Clone)]
pub(super) struct LinearFit {
    pub(super) fit: LeastSquares,
    pub(super) weights: Option<BlockWhitening>,
    pub(super) noise: NoiseModel,
    pub(super) basis: IntervalBasis,
}

impl LinearFit {
    /// Ordinary least squares.
    pub(super) fn ordinary(equations: &Factorisation<'_>) -> Result<Self, EstimationError> {
        Self::of(equations, equations.least_squares()?.clone(), None)
    }

    /// Least squares weighted with the scatter over periods, or with the residual of the ordinary fit.
    pub(super) fn weighted(equations: &Factorisation<'_>) -> Result<Self, EstimationError> {
        if let Some((weights, fit)) = equations.by_scatter()? {
            return Self::of(equations, fit.clone(), Some(weights.clone()));
        }
        Self::with_weights(equations, equations.residual_weights(equations.least_squares()?.solution())?)
    }

    /// Least squares weighted with the inverse of a covariance that is known otherwise.
    pub(super) fn with_weights(
        equations: &Factorisation<'_>,
        weights: BlockWhitening,
    ) -> Result<Self, EstimationError> {
        Self::of(equations, equations.weighted(&weights)?, Some(weights))
    }

    fn of(
        equations: &Factorisation<'_>,
        fit: LeastSquares,
        weights: Option<BlockWhitening>,
    ) -> Result<Self, EstimationError> {
        let (noise, basis) = noise_of(equations.observation(), &fit);
        Ok(Self { fit, weights, noise, basis })
    }

    /// What the equations are multiplied with.
    pub(super) fn instruments(&self) -> Instruments<'_> {
        self.weights.as_ref().map_or(Instruments::Regressor, Instruments::Weighted)
    }

    /// The estimate whose solution is `fit`, this one's own or one near it.
    pub(super) fn estimate(
        &self,
        estimator: &str,
        problem: &EstimationProblem<'_>,
        fit: &LeastSquares,
        termination: Termination,
    ) -> Result<Estimate, EstimationError> {
        Inference {
            estimator,
            problem,
            fit,
            instruments: self.instruments(),
            noise: &self.noise,
            basis: self.basis,
            termination,
        }
        .estimate()
    }

    /// Sum of the squares of the (weighted) residual of the solution.
    pub(super) fn misfit(&self, observation: &Observation) -> Result<f64, EstimationError> {
        let residual = observation.residual(self.fit.solution());
        let white = match &self.weights {
            Some(weights) => observation.white(weights, &residual)?,
            None => residual,
        };
        Ok(white.norm_squared())
    }

    /// Sum of the squares of the (weighted) residual over the degrees of freedom: 1 or so by weights that are the noise.
    pub(super) fn residual_variance(&self, observation: &Observation) -> Result<f64, EstimationError> {
        let freedom = observation.equations().saturating_sub(self.fit.solution().len()).max(1);
        Ok(self.misfit(observation)? / freedom as f64)
    }
}
