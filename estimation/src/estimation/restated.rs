//! An estimate with other values or error bars than those of its equations.

use nalgebra::{DMatrix, DVector};

use super::linear_fit::LinearFit;
use super::{BaseEstimate, Estimate, EstimationError, EstimationProblem, Finding, IntervalBasis, Termination};
use crate::linalg::LeastSquares;
use crate::statistics::student_quantile;

/// A value whose standard deviation is more than a third of it is reported.
const UNCERTAIN: f64 = 3.0;

/// Parameters whose standard deviation is more than a third of their value.
pub(super) fn poorly_determined(base: &[BaseEstimate]) -> Vec<Finding> {
    let poor = base.iter().filter(|p| UNCERTAIN * p.std > p.value.abs());
    let of = |p: &BaseEstimate| {
        let (parameter, unit) = (p.name.clone(), p.unit.clone());
        Finding::PoorlyDetermined { parameter, value: p.value, std: p.std, unit }
    };
    poor.map(of).collect()
}

impl Estimate {
    /// The estimate of an estimator from outside: its parameters β̂ (b) with their covariance (b × b) and the degrees of freedom
    /// behind it, infinite where the covariance is known. Names, units, 95 % intervals of Student's t, residuals and findings
    /// follow from the problem, and a full set of parameters where it has a nominal one.
    ///
    /// # Errors
    /// [`EstimationError::Count`] where sizes differ from those of the base, [`EstimationError::NotFinite`] of a value that is no
    /// number, [`EstimationError::NotDefinite`] of a variance below zero or no degrees of freedom.
    pub fn of(
        estimator: &str,
        problem: &EstimationProblem<'_>,
        beta: &DVector<f64>,
        covariance: &DMatrix<f64>,
        degrees_of_freedom: f64,
    ) -> Result<Self, EstimationError> {
        let expected = problem.observation.base.rank();
        for (quantity, found) in [
            ("parameters of the estimate", beta.len()),
            ("rows of its covariance", covariance.nrows()),
            ("columns of its covariance", covariance.ncols()),
        ] {
            if found != expected {
                return Err(EstimationError::Count { quantity, found, expected });
            }
        }
        for (quantity, values) in
            [("parameters of the estimate", beta.as_slice()), ("covariance of the estimate", covariance.as_slice())]
        {
            if values.iter().any(|value| !value.is_finite()) {
                return Err(EstimationError::NotFinite { quantity });
            }
        }
        if !(degrees_of_freedom > 0.0 && covariance.diagonal().iter().all(|variance| *variance >= 0.0)) {
            return Err(EstimationError::NotDefinite);
        }
        let equations = problem.factorised()?;
        let linear = LinearFit::ordinary(&equations)?;
        let fit = LeastSquares::from_factors(
            beta.clone(),
            [linear.fit.inverse_information(), DMatrix::identity(expected, expected)],
            linear.fit.condition(),
            linear.fit.condition_scaled(),
        )?;
        let estimate = linear.estimate(estimator, problem, &fit, Termination::Direct)?;
        let basis = IntervalBasis::Residual;
        Ok(Self { degrees_of_freedom, interval_basis: basis, ..estimate }.with_covariance(covariance))
    }

    /// With another covariance (b × b), and intervals of its standard deviations around the values.
    pub(super) fn with_covariance(mut self, covariance: &DMatrix<f64>) -> Self {
        let t = student_quantile(0.975, self.degrees_of_freedom);
        for (j, p) in self.base.iter_mut().enumerate() {
            p.std = covariance[(j, j)].max(0.0).sqrt();
            p.ci95 = [p.value - t * p.std, p.value + t * p.std];
        }
        let b = self.base.len();
        self.covariance =
            (0..b).map(|i| (0..b).map(|j| 0.5 * (covariance[(i, j)] + covariance[(j, i)])).collect()).collect();
        self.findings.retain(|finding| !matches!(finding, Finding::PoorlyDetermined { .. }));
        let mut findings = poorly_determined(&self.base);
        findings.append(&mut self.findings);
        Self { findings, ..self }
    }
}
