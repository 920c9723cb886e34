//! From a solved least-squares problem to an estimate: covariance, intervals, findings.
//!
//! ```text
//! cov β̂ = (WᵀPW)⁻¹ (PW)ᵀ C (PW) (WᵀPW)⁻¹        P = 1 (OLS) or Σ⁻¹ (WLS)
//! ```
//! with the covariance C of all equations, correlation in time included. For white noise and P = Σ⁻¹ the middle part
//! cancels against one factor and `(WᵀΣ⁻¹W)⁻¹` remains. One term adds to the model's own b parameters nothing: model
//! errors are not in C when it comes from scatter, and findings tell where the residual says that there are some.

use nalgebra::{DMatrix, DVector};

use super::residual::{joint_rms, neighbour_correlation};
use super::{
    BaseEstimate, Estimate, EstimationError, EstimationProblem, Finding, IntervalBasis, Observation, StandardEstimate,
    Termination, complete, student_quantile_975,
};
use crate::linalg::{LeastSquares, LeastSquaresError, transpose_product};
use crate::signal::NoiseModel;

/// A condition number with unit columns above this is worth telling: a relative error of a hundredth in the data can
/// then become one of the size of the parameters.
const LARGE_CONDITION: f64 = 100.0;
/// Residuals above this multiple of what noise explains are worth telling.
const LARGE_RESIDUAL: f64 = 1.5;
/// Correlation of neighbouring residuals beyond that of the noise that is worth telling.
const LARGE_CORRELATION: f64 = 0.3;
/// Fewer periods than this are worth telling.
const FEW_PERIODS: usize = 4;

/// A solved problem on its way to an estimate.
pub(super) struct Appraisal<'a> {
    pub(super) estimator: &'static str,
    pub(super) problem: &'a EstimationProblem<'a>,
    pub(super) fit: &'a LeastSquares,
    /// P W, (n·M) × b.
    pub(super) weighted: &'a DMatrix<f64>,
    pub(super) noise: &'a NoiseModel,
    pub(super) basis: IntervalBasis,
    pub(super) termination: Termination,
}

impl Appraisal<'_> {
    pub(super) fn estimate(self) -> Result<Estimate, EstimationError> {
        let observation = self.problem.observation;
        let beta = self.fit.solution();
        let covariance = self.fit.sandwich(&transpose_product(self.weighted, &self.noise.apply(self.weighted)));
        let freedom = self.noise.degrees_of_freedom();
        let t = student_quantile_975(freedom);
        let base: Vec<BaseEstimate> = observation
            .base
            .names()
            .into_iter()
            .enumerate()
            .map(|(j, name)| {
                let (value, std) = (beta[j], covariance[(j, j)].max(0.0).sqrt());
                let unit = observation.parameter_units[j].clone();
                BaseEstimate { name, value, std, ci95: [value - t * std, value + t * std], unit }
            })
            .collect();
        let residual = observation.residual(beta);
        let residual_rms = joint_rms(residual.as_slice(), observation.dof);
        let mut findings = self.findings(&base, &residual, &residual_rms);
        let completion = match self.problem.nominal {
            Some(nominal) => Some(complete(&observation.base, beta, nominal)?),
            None => None,
        };
        if let Some(completion) = &completion {
            findings.extend(completion.findings.iter().cloned());
        }
        let b = base.len();
        Ok(Estimate {
            estimator: self.estimator.to_owned(),
            robot: observation.robot.clone(),
            columns: observation.columns.name().to_owned(),
            covariance: (0..b).map(|i| covariance.row(i).iter().copied().collect()).collect(),
            consistent: completion.as_ref().map(|c| c.findings.is_empty()),
            standard: completion.map(|c| {
                let values = observation.base.parameters.iter();
                values.map(|&id| StandardEstimate { name: id.to_string(), value: c.parameters.get(id) }).collect()
            }),
            residual_rms,
            noise_std: self.noise.std(),
            units: observation.units.clone(),
            condition: self.fit.condition(),
            condition_scaled: self.fit.condition_scaled(),
            interval_basis: self.basis,
            degrees_of_freedom: freedom,
            samples: observation.samples(),
            periods: observation.periods,
            base,
            findings,
            termination: self.termination,
            provenance: observation.provenance.clone(),
        })
    }

    fn findings(&self, base: &[BaseEstimate], residual: &DVector<f64>, rms: &[f64]) -> Vec<Finding> {
        let observation = self.problem.observation;
        let mut findings = Vec::new();
        for p in base.iter().filter(|p| 3.0 * p.std > p.value.abs()) {
            let (parameter, unit) = (p.name.clone(), p.unit.clone());
            findings.push(Finding::PoorlyDetermined { parameter, value: p.value, std: p.std, unit });
        }
        let condition_scaled = self.fit.condition_scaled();
        if condition_scaled > LARGE_CONDITION {
            findings.push(Finding::LargeCondition { condition_scaled });
        }
        if self.basis == IntervalBasis::Residual {
            findings.push(Finding::NoiseFromResidual);
            return findings;
        }
        if observation.periods < FEW_PERIODS {
            findings.push(Finding::FewPeriods { periods: observation.periods });
        }
        let left = (1.0 - base.len() as f64 / observation.y.len() as f64).max(0.0).sqrt();
        let correlations = neighbour_correlation(residual.as_slice(), observation.dof);
        for (i, noise_std) in self.noise.std().into_iter().enumerate() {
            let (expected_rms, residual_rms) = (noise_std * left, rms[i]);
            let joint = i + 1;
            if residual_rms > LARGE_RESIDUAL * expected_rms {
                let ratio = residual_rms / expected_rms;
                let unit = observation.units[i].clone();
                findings.push(Finding::ResidualAboveNoise { joint, residual_rms, expected_rms, ratio, unit });
            }
            let (correlation, expected) = (correlations[i], self.noise.correlation(i, 1));
            if correlation > expected + LARGE_CORRELATION {
                findings.push(Finding::ResidualCorrelated { joint, correlation, expected });
            }
        }
        findings
    }
}

/// Solves the equations and names a column that the trajectory does not excite.
pub(super) fn solve(
    observation: &Observation,
    w: &DMatrix<f64>,
    y: &DVector<f64>,
) -> Result<LeastSquares, EstimationError> {
    LeastSquares::solve(w, y).map_err(|error| match error {
        LeastSquaresError::Dependent { column, independent, least } => {
            let parameter = observation.base.names()[column].clone();
            EstimationError::NotExcited { parameter, independent, least }
        }
        other => other.into(),
    })
}
