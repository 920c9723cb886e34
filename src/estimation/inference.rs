//! From a solved least-squares problem to an estimate: covariance, intervals, findings.
//!
//! ```text
//! cov β̂ = (WᵀPW)⁻¹ (PW)ᵀ C (PW) (WᵀPW)⁻¹        P = 1 (OLS) or Σ⁻¹ (WLS)
//! ```
//! with the covariance C of all equations, correlation in time included. For white noise and P = Σ⁻¹ the middle part
//! cancels against one factor and `(WᵀΣ⁻¹W)⁻¹` remains.
//!
//! The scatter over periods does not see what repeats: model errors, errors of the measured motion. Where the residual
//! of a joint is much larger than the scatter explains, a finding says so, and C is taken from the residual instead,
//! with its correlation in time: intervals then hold model errors as far as these look like noise.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::residual::{joint_rms, neighbour_correlation};
use super::{
    BaseEstimate, Estimate, EstimationError, EstimationProblem, Finding, IntervalBasis, Observation, StandardEstimate,
    Termination, complete, residual_noise,
};
use crate::linalg::{LeastSquares, LeastSquaresError, product, transpose_product};
use crate::signal::NoiseModel;
use crate::statistics::student_quantile;

/// A condition number with unit columns above this is reported: a relative error of a hundredth in the data can
/// then become one of the size of the parameters.
const LARGE_CONDITION: f64 = 100.0;
/// Residuals above this multiple of what noise explains are reported. Below two, the residual of a quiet joint in
/// an ordinary fit gets there by chance: few directions of the others' noise leak into it.
const LARGE_RESIDUAL: f64 = 2.0;
/// Correlation of neighbouring residuals beyond that of the noise that is reported.
const LARGE_CORRELATION: f64 = 0.3;
/// Smallest variance of a parameter, and of a combination of parameters, as a part of that under white noise, that lag
/// covariances may lead to.
const LEAST_VARIANCE: f64 = 0.2;
/// Fewer periods than this are reported.
const FEW_PERIODS: usize = 4;

/// From a solution to an [`Estimate`]: covariance, intervals, completed standard parameters, findings. An estimator fills the
/// fields and calls [`Inference::estimate`].
///
/// A solution that is no least-squares fit comes in by [`LeastSquares::from_factors`], with B in place of P W.
#[derive(Clone, Copy, Debug)]
pub struct Inference<'a> {
    /// Name of the estimator.
    pub estimator: &'static str,
    /// What it was given.
    pub problem: &'a EstimationProblem<'a>,
    /// β̂ and A⁻¹, with the condition of the equations.
    pub fit: &'a LeastSquares,
    /// P W, or B, (n·M) × b; zero in rows that are no equation.
    pub weighted: &'a DMatrix<f64>,
    /// Noise of the equations: of [`scatter_noise`](super::scatter_noise) where there is one, else of
    /// [`residual_noise`](super::residual_noise).
    pub noise: &'a NoiseModel,
    /// Which of the two it is.
    pub basis: IntervalBasis,
    /// How the estimator ended.
    pub termination: Termination,
}

impl Inference<'_> {
    /// The estimate.
    ///
    /// # Errors
    /// [`EstimationError`] where the nominal set of the problem is of another arm.
    pub fn estimate(self) -> Result<Estimate, EstimationError> {
        let observation = self.problem.observation;
        let beta = self.fit.solution();
        let residual = observation.residual(beta);
        let residual_rms = joint_rms(residual.as_slice(), &observation.used, observation.dof);
        let (spread, covariance) = self.covariance(self.noise);
        let expected = ExpectedResidual::new(&self, &spread, &covariance);
        let misfit = self.misfit(&residual_rms, &expected);
        let (covariance, freedom, interval_basis) = if misfit.is_empty() {
            (covariance, self.noise.degrees_of_freedom(), self.basis)
        } else {
            let seen = residual_noise(observation, &residual);
            (self.covariance(&seen).1, seen.degrees_of_freedom(), IntervalBasis::Residual)
        };
        let t = student_quantile(0.975, freedom);
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
        let mut findings = self.findings(&base, &residual, &expected);
        findings.extend(misfit);
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
            columns: observation.columns.to_string(),
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
            interval_basis,
            degrees_of_freedom: freedom,
            samples: observation.samples(),
            periods: observation.periods,
            base,
            findings,
            termination: self.termination,
            provenance: observation.provenance.clone(),
        })
    }

    /// C P W and cov β̂ for one noise.
    fn covariance(&self, noise: &NoiseModel) -> (DMatrix<f64>, DMatrix<f64>) {
        let of = |noise: &NoiseModel| {
            let spread = noise.apply(self.weighted);
            let covariance = self.fit.sandwich(&transpose_product(self.weighted, &spread));
            (spread, covariance)
        };
        let (spread, covariance) = of(noise);
        if noise.length() == 0 {
            return (spread, covariance);
        }
        // Neighbours of opposite sign shorten error bars. By more than this is not believed of measured lags, whose
        // sum can even be negative.
        let white = NoiseModel::white(noise.covariance().clone(), false, noise.degrees_of_freedom());
        let (_, least) = of(&white);
        let (spread, covariance) =
            if (0..covariance.nrows()).all(|j| covariance[(j, j)] > LEAST_VARIANCE * least[(j, j)]) {
                (spread, covariance)
            } else {
                of(&noise.tapered())
            };
        let covariance = raised(covariance, &least);
        (spread, covariance)
    }

    /// Joints whose residual is much larger than scatter explains.
    fn misfit(&self, rms: &[f64], expected: &ExpectedResidual) -> Vec<Finding> {
        if self.basis == IntervalBasis::Residual {
            return Vec::new();
        }
        let joints = rms.iter().zip(&expected.rms).zip(&self.problem.observation.units).enumerate();
        joints
            .filter(|(_, ((residual_rms, expected_rms), _))| **residual_rms > LARGE_RESIDUAL * **expected_rms)
            .map(|(i, ((&residual_rms, &expected_rms), unit))| Finding::ResidualAboveNoise {
                joint: i + 1,
                residual_rms,
                expected_rms,
                ratio: residual_rms / expected_rms,
                unit: unit.clone(),
            })
            .collect()
    }

    fn findings(&self, base: &[BaseEstimate], residual: &DVector<f64>, expected: &ExpectedResidual) -> Vec<Finding> {
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
        for (i, correlation) in neighbour_correlation(residual.as_slice(), observation.dof).into_iter().enumerate() {
            let expected = expected.correlation[i];
            if correlation > expected + LARGE_CORRELATION {
                findings.push(Finding::ResidualCorrelated { joint: i + 1, correlation, expected });
            }
        }
        findings
    }
}

/// A covariance whose variance in no direction is below [`LEAST_VARIANCE`] of that under white noise, so that it is
/// positive definite for any measured lags: with `least = L Lᵀ`, the eigenvalues of `L⁻¹ C L⁻ᵀ` are raised.
fn raised(covariance: DMatrix<f64>, least: &DMatrix<f64>) -> DMatrix<f64> {
    let Some(factor) = Cholesky::new(least.clone()).map(|cholesky| cholesky.l()) else {
        return covariance;
    };
    let Some(half) = factor.solve_lower_triangular(&covariance) else { return covariance };
    let Some(ratio) = factor.solve_lower_triangular(&half.transpose()) else { return covariance };
    let eigen = SymmetricEigen::new((&ratio + ratio.transpose()) * 0.5);
    if eigen.eigenvalues.min() >= LEAST_VARIANCE {
        return covariance;
    }
    let mut root = product(&factor, &eigen.eigenvectors);
    for (mut column, &value) in root.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(LEAST_VARIANCE).sqrt();
    }
    product(&root, &root.transpose())
}

/// What noise alone would leave as residual, per joint.
///
/// ```text
/// r = (1 − W G) ε,  G = (WᵀPW)⁻¹ (PW)ᵀ        cov r = C − W G C − (W G C)ᵀ + W (cov β̂) Wᵀ
/// ```
/// Not simply the noise of that joint: in an ordinary fit the noise of a strong joint moves parameters that a quiet
/// joint feels.
struct ExpectedResidual {
    rms: Vec<f64>,
    /// Correlation of neighbours.
    correlation: Vec<f64>,
}

impl ExpectedResidual {
    /// `spread` is C P W.
    fn new(inference: &Inference<'_>, spread: &DMatrix<f64>, covariance: &DMatrix<f64>) -> Self {
        let observation = inference.problem.observation;
        let (n, w) = (observation.dof, &observation.regressor);
        // Rows in turn, so work on transposes: column k of each is what belongs to equation k.
        let gain = product(&inference.fit.inverse_information().transpose(), &w.transpose());
        let fitted = product(covariance, &w.transpose());
        let (w, spread) = (w.transpose(), spread.transpose());
        let noise = inference.noise;
        let (mut power, mut neighbours, mut counts) = (vec![0.0; n], vec![0.0; n], vec![0_u32; n]);
        for row in 0..observation.y.len() {
            let i = row % n;
            let next = row + n;
            for (other, sums) in [(row, &mut power), (next, &mut neighbours)] {
                if other < observation.y.len() && observation.used[row] && observation.used[other] {
                    let own = noise.covariance()[(i, i)];
                    let raw = if other == row { own } else { own * noise.correlation(i, 1) };
                    sums[i] +=
                        raw - gain.column(row).dot(&spread.column(other)) - gain.column(other).dot(&spread.column(row))
                            + fitted.column(row).dot(&w.column(other));
                }
            }
            counts[i] += u32::from(observation.used[row]);
        }
        Self {
            rms: power.iter().zip(&counts).map(|(p, &c)| (p.max(0.0) / f64::from(c.max(1))).sqrt()).collect(),
            correlation: power.iter().zip(&neighbours).map(|(&p, n)| if p > 0.0 { n / p } else { 0.0 }).collect(),
        }
    }
}

/// Solves `min ‖y − W β‖` for weighted equations of an observation, (n·M) × b, and names a column that the trajectory does
/// not excite.
///
/// # Errors
/// [`EstimationError::NotExcited`] with the parameter's name; [`EstimationError::LeastSquares`] for what else can be wrong with
/// the equations.
pub fn solve(observation: &Observation, w: &DMatrix<f64>, y: &DVector<f64>) -> Result<LeastSquares, EstimationError> {
    LeastSquares::solve(w, y).map_err(|error| match error {
        LeastSquaresError::Dependent { column, independent, least } => {
            let parameter = observation.base.names()[column].clone();
            EstimationError::NotExcited { parameter, independent, least }
        }
        other => other.into(),
    })
}
