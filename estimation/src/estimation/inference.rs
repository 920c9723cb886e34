//! From a solved least-squares problem to an estimate: covariance, intervals, findings.
//!
//! ```text
//! cov β̂ = (WᵀPW)⁻¹ (PW)ᵀ C (PW) (WᵀPW)⁻¹        P = 1 (OLS) or Σ⁻¹ (WLS)
//! ```
//! with the covariance C of all equations, correlation in time included. For white noise and P = Σ⁻¹ the middle part
//! cancels against one factor and `(WᵀΣ⁻¹W)⁻¹` remains.
//!
//! The scatter over periods does not see what repeats: model errors, errors of the measured motion. Where the residual of a
//! joint is much larger than the scatter explains, C is taken from the residual with its correlation in time: that sees what
//! joints say against each other, as under wrong torque constants. What single joints show of a torque that no parameter of
//! theirs explains is added as a [`discrepancy`](super::discrepancy), where the states of the equations are known. Torque by laws that
//! drives have and the model omits is added with or without periods, where it is looked for ([`omitted`](super::omitted)). What leaves no
//! trace in any residual is added as far as the robot file declares it ([`declared`](super::declared)).

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::completion::complete;
use super::declared::declared;
use super::error::EstimationError;
use super::estimate::{BaseEstimate, Estimate, IntervalBasis, StandardEstimate, rows_of, symmetric_rows_of};
use super::expected_residual::ExpectedResidual;
use super::factorisation::Factorisation;
use super::finding::Finding;
use super::instruments::COLUMNS;
use super::instruments::Instruments;
use super::observation::Observation;
use super::poorly_determined::poorly_determined;
use super::problem::EstimationProblem;
use super::residual::{ResidualScale, joint_rms, neighbour_correlation};
use super::residual::{residual_noise, scatter_noise};
use super::termination::Termination;
use crate::linalg::{LeastSquares, product};
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
/// A solution that is no least-squares fit comes in by [`LeastSquares::from_factors`], with its B as [`Instruments::Rows`].
#[derive(Clone, Copy, Debug)]
pub struct Inference<'a> {
    /// Name of the estimator.
    pub estimator: &'a str,
    /// What it was given.
    pub problem: &'a EstimationProblem<'a>,
    /// β̂ and A⁻¹, with the condition of the equations.
    pub fit: &'a LeastSquares,
    /// P W, or B.
    pub instruments: Instruments<'a>,
    /// Noise of the equations: of [`scatter_noise`](super::scatter_noise) where there is one, else of
    /// [`residual_noise`].
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
        Ok(self.inferred(self.problem.observation)?.estimate)
    }

    /// The estimate with intervals from `noise` of a residual, as of an estimator that has one of its own. Where there is scatter
    /// over periods, findings about the residual come from that: what noise alone would leave. What the scatter shows that the model
    /// lacks is added as for any other estimator, looked for in `kept`, the equations that the estimator did not give up.
    pub(super) fn with_residual_noise(self, kept: &Observation) -> Result<Estimate, EstimationError> {
        let Some(scatter) = scatter_noise(self.problem.observation) else {
            return Inference { basis: IntervalBasis::Residual, ..self }.estimate();
        };
        let of_scatter = Inference { noise: &scatter, basis: IntervalBasis::Scatter, ..self }.inferred(kept)?;
        let mut estimate = Inference { basis: IntervalBasis::Residual, ..self }.estimate()?;
        if let Some(discrepancy) = &of_scatter.discrepancy {
            estimate.add_covariance(discrepancy);
            estimate.interval_basis = IntervalBasis::Discrepancy;
        }
        let is_of_std = |finding: &Finding| matches!(finding, Finding::PoorlyDetermined { .. });
        estimate.findings = poorly_determined(&estimate.base);
        estimate.findings.extend(of_scatter.estimate.findings.into_iter().filter(|finding| !is_of_std(finding)));
        estimate.noise_std = of_scatter.estimate.noise_std;
        Ok(estimate)
    }

    /// The estimate, and what of its covariance is a discrepancy, which is looked for in the equations `kept`.
    fn inferred(self, kept: &Observation) -> Result<Inferred, EstimationError> {
        let observation = self.problem.observation;
        let beta = self.fit.solution();
        let equations = self.problem.factorised()?;
        let residual_rms = ResidualScale::of(observation).rms(&equations.residual_products(beta));
        let (noise, mut covariance) = self.covariance(&equations, self.noise)?;
        let by_noise = covariance.clone();
        let (mut freedom, mut interval_basis) = (self.freedom(self.noise), self.basis);
        let (mut beyond, mut found) = (Vec::new(), None);
        if self.basis == IntervalBasis::Scatter {
            let expected = ExpectedResidual::new(self.problem, self.fit, self.instruments, &noise, &covariance)?;
            // What omitted laws explain is in their part of the covariance.
            let mut left = observation.residual(beta);
            let mut left_rms = residual_rms.clone();
            if let Some(omitted) = &equations.omitted {
                left -= omitted.left(observation, self.fit, self.instruments)?;
                left_rms = joint_rms(left.as_slice(), &observation.used, observation.dof);
            }
            beyond = self.correlated(&left, &expected);
            let misfit = self.misfit(&left_rms, &expected);
            if !misfit.is_empty() {
                let seen = residual_noise(observation, &left);
                covariance = self.covariance(&equations, &seen)?.1;
                (freedom, interval_basis) = (self.freedom(&seen), IntervalBasis::Residual);
            }
            if let Some(shown) = self.discrepancy(&equations, kept)? {
                covariance += &shown.covariance;
                interval_basis = IntervalBasis::Discrepancy;
                beyond.extend(shown.findings);
                found = Some(shown.covariance);
            }
            // Errors of the measured motion make a misfit too, which widens the intervals and is no finding.
            let motion = equations.omitted.as_ref().and_then(|omitted| omitted.motion.as_ref());
            beyond.extend(misfit.into_iter().filter(|finding| is_beyond_motion(finding, motion)));
        }
        if let Some(omitted) = &equations.omitted {
            covariance += omitted.covariance(observation, self.fit, self.instruments)?;
            beyond.extend_from_slice(&omitted.findings);
        }
        let declared = declared(self.problem, self.fit, self.instruments)?;
        if let Some(declared) = &declared {
            covariance += &declared.covariance;
        }
        let t = student_quantile(0.975, freedom);
        let parameter = |(j, name): (usize, String)| {
            let (value, std) = (beta[j], covariance[(j, j)].max(0.0).sqrt());
            let unit = observation.parameter_units[j].clone();
            let declared_std = declared.as_ref().map_or(0.0, |of| of.covariance[(j, j)].max(0.0).sqrt());
            BaseEstimate { name, value, std, ci95: [value - t * std, value + t * std], unit, declared_std }
        };
        let base: Vec<BaseEstimate> = observation.base.names().into_iter().enumerate().map(parameter).collect();
        let condition_scaled = self.fit.condition_scaled();
        let mut findings = self.findings(&base, condition_scaled);
        findings.extend(beyond);
        findings.extend(observation.base.nearly_dependent.as_ref().map(|left_out| Finding::NearlyDependent {
            parameters: left_out.parameters.clone(),
            tolerance: left_out.tolerance,
        }));
        let nominal = self.problem.nominal;
        let completion = nominal.map(|nominal| complete(&observation.base, beta, nominal)).transpose()?;
        if let Some(completion) = &completion {
            findings.extend(completion.findings.iter().cloned());
        }
        let motor_errors = declared.map(|of| of.of_motors).filter(|of| of.ncols() > 0);
        let estimate = Estimate {
            estimator: self.estimator.to_owned(),
            robot: observation.robot.clone(),
            columns: observation.columns.to_string(),
            shape: observation.shape.clone(),
            noise_covariance: if covariance == by_noise { Vec::new() } else { symmetric_rows_of(by_noise) },
            covariance: rows_of(&covariance),
            motor_errors: motor_errors.as_ref().map(rows_of).unwrap_or_default(),
            consistent: completion.as_ref().map(|c| c.findings.is_empty()),
            servo: Vec::new(),
            standard: completion.map(|c| {
                let values = observation.base.parameters.iter();
                values.map(|&id| StandardEstimate { name: id.to_string(), value: c.parameters.get(id) }).collect()
            }),
            residual_rms,
            noise_std: self.noise.std(),
            units: observation.units.clone(),
            condition: self.fit.condition(),
            condition_scaled,
            factorised_by: equations.factorised_by,
            interval_basis,
            degrees_of_freedom: freedom,
            samples: observation.samples(),
            periods: observation.periods,
            base,
            effects: equations.omitted.as_ref().map_or_else(Vec::new, |omitted| omitted.sizes.clone()),
            findings,
            termination: self.termination,
            provenance: observation.provenance.clone(),
        };
        Ok(Inferred { estimate, discrepancy: found })
    }

    /// Degrees of freedom of intervals by this noise. What repeats with the period is no random process, and has a discrepancy of its own.
    fn freedom(&self, noise: &NoiseModel) -> f64 {
        if self.problem.observation.periodic { noise.degrees_of_freedom } else { noise.interval_freedom() }
    }

    /// cov β̂ of what the equations `kept` show that the model lacks, and the joints that show it.
    fn discrepancy(&self, equations: &Factorisation<'_>, kept: &Observation) -> Result<Option<Shown>, EstimationError> {
        let Some(samples) = self.problem.samples else { return Ok(None) };
        let observation = self.problem.observation;
        let mut of_kept = (!std::ptr::eq(kept, observation)).then(|| Factorisation::new(kept)).transpose()?;
        of_kept.iter_mut().for_each(|of| of.omitted.clone_from(&equations.omitted));
        let Some(found) = of_kept.as_ref().unwrap_or(equations).discrepancy(samples)? else { return Ok(None) };
        let functions = found.products(observation, self.instruments)?;
        let covariance = self.fit.sandwich(&(functions + self.products(equations, &found.white())?));
        Ok(Some(Shown { covariance, findings: found.findings.clone() }))
    }

    /// cov β̂ for one noise, and that noise as it was believed.
    pub(super) fn covariance(
        &self,
        equations: &Factorisation<'_>,
        noise: &NoiseModel,
    ) -> Result<(NoiseModel, DMatrix<f64>), EstimationError> {
        let of = |noise: &NoiseModel| Ok::<_, EstimationError>(self.fit.sandwich(&self.products(equations, noise)?));
        if noise.length() == 0 {
            return Ok((noise.clone(), of(noise)?));
        }
        // Neighbours of opposite sign shorten error bars. By more than this is not believed of measured lags, whose
        // sum can even be negative.
        let least = of(&NoiseModel::white(noise.covariance().clone(), false, noise.degrees_of_freedom))?;
        let (mut believed, mut covariance) = (noise.clone(), of(noise)?);
        if !(0..covariance.nrows()).all(|j| covariance[(j, j)] > LEAST_VARIANCE * least[(j, j)]) {
            believed = noise.tapered();
            covariance = of(&believed)?;
        }
        Ok((believed, raised(covariance, &least)))
    }

    /// `Bᵀ C B`, b × b: by the factorisation where the noise is white in time, else from the rows, a few columns at a time.
    fn products(&self, equations: &Factorisation<'_>, noise: &NoiseModel) -> Result<DMatrix<f64>, EstimationError> {
        match self.instruments {
            Instruments::Regressor if noise.length() == 0 => {
                return equations.white_noise_products(None, noise.covariance());
            }
            Instruments::Weighted(weights) if noise.length() == 0 => {
                return equations.white_noise_products(Some(weights), noise.covariance());
            }
            Instruments::Regressor | Instruments::Weighted(_) | Instruments::Rows(_) => {}
        }
        let observation = self.problem.observation;
        let b = self.fit.solution().len();
        let operator = noise.operator(observation.samples());
        let mut products = DMatrix::zeros(b, b);
        for first in (0..b).step_by(COLUMNS) {
            let range = first..(first + COLUMNS).min(b);
            let columns = self.instruments.columns(observation, range.clone())?;
            let spread = operator.apply_to_columns(&columns, observation.regressor.nrows());
            products.columns_range_mut(range).copy_from(&self.instruments.transposed_product(observation, &spread)?);
        }
        Ok(products)
    }

    /// Joints whose residual is much larger than scatter explains; of one without a degree of freedom nothing is expected.
    fn misfit(&self, rms: &[f64], expected: &ExpectedResidual) -> Vec<Finding> {
        let joints = rms.iter().zip(&expected.rms).zip(&self.problem.observation.units).enumerate();
        joints
            .filter(|(_, ((residual, expected), _))| **expected > 0.0 && **residual > LARGE_RESIDUAL * **expected)
            .map(|(i, ((&residual_rms, &expected_rms), unit))| Finding::ResidualAboveNoise {
                joint: i + 1,
                residual_rms,
                expected_rms,
                ratio: residual_rms / expected_rms,
                unit: unit.clone(),
            })
            .collect()
    }

    /// Joints whose residual is related to the one before more than noise is.
    fn correlated(&self, residual: &DVector<f64>, expected: &ExpectedResidual) -> Vec<Finding> {
        let found = neighbour_correlation(residual.as_slice(), self.problem.observation.dof);
        let finding = |(i, (correlation, &expected)): (usize, (f64, &f64))| {
            let joint = i + 1;
            let is_large = correlation > expected + LARGE_CORRELATION;
            is_large.then_some(Finding::ResidualCorrelated { joint, correlation, expected })
        };
        found.into_iter().zip(&expected.correlation).enumerate().filter_map(finding).collect()
    }

    fn findings(&self, base: &[BaseEstimate], condition_scaled: f64) -> Vec<Finding> {
        let mut findings = poorly_determined(base);
        if !self.termination.was_successful() {
            findings.push(Finding::Unfinished { termination: self.termination });
        }
        if condition_scaled > LARGE_CONDITION {
            findings.push(Finding::LargeCondition { condition_scaled });
        }
        let periods = self.problem.observation.periods;
        match self.basis {
            IntervalBasis::Residual => findings.push(Finding::NoiseFromResidual),
            IntervalBasis::Scatter | IntervalBasis::Discrepancy if periods < FEW_PERIODS => {
                findings.push(Finding::FewPeriods { periods });
            }
            IntervalBasis::Scatter | IntervalBasis::Discrepancy => {}
        }
        findings
    }
}

/// Whether a residual is large beside noise and what errors of the measured motion add to it.
fn is_beyond_motion(finding: &Finding, motion: Option<&NoiseModel>) -> bool {
    let (Finding::ResidualAboveNoise { joint, residual_rms, expected_rms, .. }, Some(motion)) = (finding, motion)
    else {
        return true;
    };
    let by_motion = motion.covariance()[(joint - 1, joint - 1)];
    *residual_rms > LARGE_RESIDUAL * (expected_rms * expected_rms + by_motion).sqrt()
}

/// What the equations show that the model lacks.
struct Shown {
    /// Its part of cov β̂.
    covariance: DMatrix<f64>,
    /// Joints that show it.
    findings: Vec<Finding>,
}

/// An estimate, and the part of its covariance that is a discrepancy.
struct Inferred {
    estimate: Estimate,
    discrepancy: Option<DMatrix<f64>>,
}

/// A covariance whose variance in no direction is below [`LEAST_VARIANCE`] of that under white noise, so that it is
/// positive definite for any measured lags: with `least = L Lᵀ`, the eigenvalues of `L⁻¹ C L⁻ᵀ` are raised.
pub(super) fn raised(covariance: DMatrix<f64>, least: &DMatrix<f64>) -> DMatrix<f64> {
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

/// Solves `min ‖y − W β‖` for weighted equations of an observation, (n·M) × b, and names a column that the trajectory does
/// not excite.
///
/// # Errors
/// [`EstimationError::NotExcited`] with the parameter's name; [`EstimationError::LeastSquares`] for what else can be wrong with
/// the equations.
pub fn solve(observation: &Observation, w: &DMatrix<f64>, y: &DVector<f64>) -> Result<LeastSquares, EstimationError> {
    LeastSquares::solve(w, y).map_err(|error| observation.named(error))
}
