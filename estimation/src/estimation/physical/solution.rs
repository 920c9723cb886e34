//! The consistent set that explains the equations of a fit best.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

use crate::estimation::consistent_set::{ConstrainedFit, Prior, ShapeBounds, constrained_fit, definite_inverse};
use crate::estimation::error::EstimationError;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::LeastSquares;
use crate::model::StandardParameters;
use crate::spatial::PseudoInertia;

/// Mass, kg, and mean square of the distance from the origin on each axis, m², of a body that stands for an unknown one. Of
/// several sets that explain the torque alike, the nearest is taken; the base parameters do not depend on it.
const UNKNOWN_BODY: (f64, f64) = (10.0, 0.1);

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
