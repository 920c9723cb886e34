//! From a linear fit to the estimate that consistency holds.

use nalgebra::{DMatrix, DVector};

use super::inference::{as_fit, restate};
use super::solution::{ConsistentFit, consistent};
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::law::{EstimatorLaw, LawException};
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::LeastSquares;

/// A residual is not taken for less than this part of the torque: what lies below is rounding of
/// sets that are a thousand times as large as their torque.
const ROUNDING: f64 = 1e-9;

/// Laws that a statement in SI does not obey.
pub(in crate::estimation) const STATED_IN_SI: &[LawException] = &[LawException {
    law: EstimatorLaw::ParameterUnits,
    reason: "what a body can have is stated in SI: columns in other units are those of other bodies",
}];

/// Laws that a prior in SI does not obey.
pub(in crate::estimation) const PRIOR_IN_SI: &[LawException] = &[
    LawException { law: EstimatorLaw::ParameterUnits, reason: "it needs a nominal set, which is stated in SI" },
    LawException {
        law: EstimatorLaw::TorqueUnits,
        reason: "the prior is stated in SI, and weighs against torque in SI",
    },
];

/// The estimate of a linear fit, held to what is consistent.
pub(super) fn estimate(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    linear: &LinearFit,
    prior: Prior,
) -> Result<Estimate, EstimationError> {
    let fit = consistent(problem, &linear.fit, variance(problem, linear)?, prior)?;
    restated(estimator, problem, linear, &fit, fit.termination)
}

/// The same of the equations around the point where a search ended, over consistent sets.
pub(super) fn estimate_by_search(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    linear: &LinearFit,
    search: Termination,
) -> Result<Estimate, EstimationError> {
    let fit = consistent(problem, &linear.fit, variance(problem, linear)?, Prior::None)?;
    restated(estimator, problem, linear, &fit, search.with_last_step(fit.termination))
}

fn restated(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    linear: &LinearFit,
    fit: &ConsistentFit,
    termination: Termination,
) -> Result<Estimate, EstimationError> {
    let plain = linear.estimate(estimator, problem, &linear.fit, Termination::Direct)?;
    let held = linear.estimate(estimator, problem, &as_fit(&linear.fit, fit)?, termination)?;
    restate(problem, &plain, held, fit)
}

/// The variance of the residual of a linear fit, above rounding.
fn variance(problem: &EstimationProblem<'_>, linear: &LinearFit) -> Result<f64, EstimationError> {
    let observation = problem.observation;
    let of_torque = LinearFit { fit: zero_of(&linear.fit)?, ..linear.clone() };
    let rounding = ROUNDING * ROUNDING * of_torque.residual_variance(observation)?;
    Ok(linear.residual_variance(observation)?.max(rounding).max(f64::MIN_POSITIVE))
}

/// The same fit with all parameters zero, whose residual is the torque.
fn zero_of(fit: &LeastSquares) -> Result<LeastSquares, EstimationError> {
    let b = fit.solution().len();
    let factors = [DMatrix::identity(b, b), DMatrix::identity(b, b)];
    Ok(LeastSquares::from_factors(DVector::zeros(b), factors, fit.condition(), fit.condition_scaled())?)
}
