//! From a linear fit to the estimate that consistency holds.

use nalgebra::{DMatrix, DVector};

use super::inference::restate;
use super::solution::consistent;
use crate::estimation::consistent_set::Prior;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::law::{EstimatorLaw, LawException};
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;

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

/// The estimate of a linear fit, held to what is consistent; of the equations around the point where a search ended, with its end.
pub(super) fn estimate(
    estimator: &str,
    problem: &EstimationProblem<'_>,
    linear: &LinearFit,
    prior: Prior,
    search: Option<Termination>,
) -> Result<Estimate, EstimationError> {
    let fit = consistent(problem, &linear.fit, variance(problem, linear)?, prior)?;
    let termination = search.map_or(fit.termination, |search| search.with_last_step(fit.termination));
    let plain = linear.estimate(estimator, problem, &linear.fit, Termination::Direct)?;
    let held = linear.fit.with_solution(fit.beta.clone(), linear.fit.inverse_information())?;
    let held = linear.estimate(estimator, problem, &held, termination)?;
    restate(problem, &plain, held, &fit)
}

/// The variance of the residual of a linear fit, above rounding.
fn variance(problem: &EstimationProblem<'_>, linear: &LinearFit) -> Result<f64, EstimationError> {
    let observation = problem.observation;
    let b = linear.fit.solution().len();
    let zero = linear.fit.with_solution(DVector::zeros(b), DMatrix::identity(b, b))?;
    // Its residual is the torque.
    let of_torque = LinearFit { fit: zero, ..linear.clone() };
    let rounding = ROUNDING * ROUNDING * of_torque.residual_variance(observation)?;
    Ok(linear.residual_variance(observation)?.max(rounding).max(f64::MIN_POSITIVE))
}
