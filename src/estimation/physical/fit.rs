//! From a linear fit to the consistent set that explains the same equations best.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

use super::inference::{as_fit, restate};
use crate::estimation::consistent_set::{ConstrainedFit, Prior, ShapeBounds, constrained_fit, definite_inverse};
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::{Estimate, EstimationError, EstimationProblem, EstimatorLaw, LawException, Termination};
use crate::linalg::LeastSquares;
use crate::model::StandardParameters;
use crate::spatial::PseudoInertia;

/// A residual is not taken for less than this part of the torque: what lies below is rounding of
/// sets that are a thousand times as large as their torque.
const ROUNDING: f64 = 1e-9;

/// Mass, kg, and mean square of the distance from the origin on each axis, m², of a body that stands for an unknown one. Of
/// several sets that explain the torque alike, the nearest is taken; the base parameters do not depend on it.
const UNKNOWN_BODY: (f64, f64) = (10.0, 0.1);

/// Laws that a statement in SI does not obey.
pub(super) const STATED_IN_SI: &[LawException] = &[LawException {
    law: EstimatorLaw::ParameterUnits,
    reason: "what a body can have is stated in SI: columns in other units are those of other bodies",
}];

/// Laws that a prior in SI does not obey.
pub(super) const PRIOR_IN_SI: &[LawException] = &[
    LawException { law: EstimatorLaw::ParameterUnits, reason: "it needs a nominal set, which is stated in SI" },
    LawException {
        law: EstimatorLaw::TorqueUnits,
        reason: "the prior is stated in SI, and weighs against torque in SI",
    },
];

/// The consistent fit, with what its error bars need.
pub(super) struct ConsistentFit {
    /// Base parameters, b.
    pub(super) beta: DVector<f64>,
    /// The full set.
    pub(super) parameters: StandardParameters,
    /// `K (∇²R)⁻¹ Kᵀ`, b × b: what the prior leaves free.
    pub(super) spread: Option<DMatrix<f64>>,
    /// A⁻¹ of the equations in units of their noise, b × b.
    pub(super) inverse: DMatrix<f64>,
    /// Whether the equations' own solution is consistent.
    pub(super) is_exact: bool,
    /// Links whose nominal body lies outside their shape.
    pub(super) beyond_shape: Vec<usize>,
    pub(super) termination: Termination,
}

/// Ordinary least squares, held to what is consistent.
pub(super) fn ordinary(
    estimator: &'static str,
    problem: &EstimationProblem<'_>,
    prior: Prior,
) -> Result<Estimate, EstimationError> {
    let equations = problem.factorised()?;
    estimate(estimator, &problem.with_factorisation(&equations), &LinearFit::ordinary(&equations)?, prior)
}

/// The same near the nominal set.
pub(super) fn near_nominal(
    estimator: &'static str,
    problem: &EstimationProblem<'_>,
    prior: Prior,
) -> Result<Estimate, EstimationError> {
    problem.nominal_for(estimator)?;
    ordinary(estimator, problem, prior)
}

/// The estimate of a linear fit, held to what is consistent.
pub(super) fn estimate(
    estimator: &'static str,
    problem: &EstimationProblem<'_>,
    linear: &LinearFit,
    prior: Prior,
) -> Result<Estimate, EstimationError> {
    let plain = linear.estimate(estimator, problem, &linear.fit, Termination::Direct)?;
    let fit = consistent(problem, &linear.fit, variance(problem, linear)?, prior)?;
    let held = linear.estimate(estimator, problem, &as_fit(&linear.fit, &fit)?, fit.termination)?;
    restate(problem, &plain, held, &fit)
}

/// Solves for a fit whose residual has the variance `variance` per degree of freedom.
pub(super) fn consistent(
    problem: &EstimationProblem<'_>,
    plain: &LeastSquares,
    variance: f64,
    prior: Prior,
) -> Result<ConsistentFit, EstimationError> {
    let base = &problem.observation.base;
    let shapes = problem.robot.map(ShapeBounds::of).unwrap_or_default();
    let guess = problem.nominal.cloned().unwrap_or_else(|| unknown_arm(problem, &shapes));
    let inverse = plain.inverse_information() * variance;
    let information = definite_inverse(&inverse).ok_or(EstimationError::NotDefinite)?;
    let fit = constrained_fit(base, (&guess, &shapes), (plain.solution(), information, &inverse), prior)?;
    let ConstrainedFit { phi, is_exact, spread, beyond_shape, termination } = fit;
    let mut parameters = guess;
    for (c, &id) in base.parameters.iter().enumerate() {
        parameters.set(id, phi[c]);
    }
    let beta = if is_exact && prior == Prior::None { plain.solution().clone() } else { base.beta(&phi) };
    Ok(ConsistentFit { beta, parameters, spread, inverse, is_exact, beyond_shape, termination })
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

fn unknown_arm(problem: &EstimationProblem<'_>, shapes: &ShapeBounds) -> StandardParameters {
    let links = problem.observation.base.parameters.iter().map(|id| id.index + 1).max().unwrap_or(0);
    let mut guess = StandardParameters::zero(links);
    let (mass, square) = UNKNOWN_BODY;
    for (link, inertia) in guess.links.iter_mut().enumerate() {
        // Where there is a shape, some mass in the middle of it: a fifth of the radius squared is a full ball's.
        let (centre, square) = shapes.ball(link).map_or((Vector3::zeros(), square), |(c, r)| (c, 0.2 * r * r));
        let x = centre.push(1.0);
        let mut p = x * x.transpose();
        for axis in 0..3 {
            p[(axis, axis)] += square;
        }
        *inertia = PseudoInertia(Matrix4::from(p) * mass).inertia();
    }
    guess
}
