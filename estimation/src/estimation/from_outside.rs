//! The estimate of an estimator from outside.

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::estimate::Estimate;
use super::estimate::IntervalBasis;
use super::linear_fit::LinearFit;
use super::problem::EstimationProblem;
use super::termination::Termination;

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
            EstimationError::unless_equal(quantity, found, expected)?;
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
        let fit = linear.fit.with_solution(beta.clone(), linear.fit.inverse_information())?;
        let estimate = linear.estimate(estimator, problem, &fit, Termination::Direct)?;
        let basis = IntervalBasis::Residual;
        let of_outside = Self { degrees_of_freedom, interval_basis: basis, motor_errors: Vec::new(), ..estimate };
        Ok(of_outside.with_covariance(covariance))
    }
}
