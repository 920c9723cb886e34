//! Equations with friction of the load, which multiplies the torque that the links take.
//!
//! ```text
//! y + S τ_l = J β + ε        J and S at β̂, the weighted fit of these equations (load_friction)
//! ```
//! The equations are bilinear in the coefficients Fl and the links' parameters. They are linearised at the weighted fit and made again until
//! it rests (Gauss–Newton). At rest the solution of the linear equations is that of the bilinear ones, and its covariance knows that the
//! load depends on β. So every linear estimator reads them as any other equations.
//!
//! Fails where the residual is so large that the fit does not rest.
//!
//! Reference: G. A. F. Seber, C. J. Wild, "Nonlinear Regression", Wiley, 1989, chapter 2.

use nalgebra::DVector;

use super::linear_fit::LinearFit;
use super::{EstimationError, Factorisation, Observation};
use crate::base::BaseReduction;
use crate::model::{ParameterId, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// Rounds until the fit must rest.
const ROUNDS: usize = 60;
/// Change of the torque of the equations, as a part of the measured one, with which it rests: what the linear equations then miss is of its square.
const REST: f64 = 1e-5;
/// The same where a term is only tested.
pub(super) const REST_OF_TESTS: f64 = 3e-3;

/// The equations of samples, as [`Observation::new`] makes them; with friction of the load linearised where their weighted fit comes to rest.
///
/// # Errors
/// As [`Observation::new`], and [`EstimationError::LoadNotAtRest`].
pub fn observe(
    robot: &Robot,
    regressor: &JointTorqueRegressor,
    base: &BaseReduction,
    samples: &Samples,
) -> Result<Observation, EstimationError> {
    observe_to(robot, regressor, base, samples, REST)
}

/// The same, friction of the load being at rest with this change of the torque.
pub(super) fn observe_to(
    robot: &Robot,
    regressor: &JointTorqueRegressor,
    base: &BaseReduction,
    samples: &Samples,
    rest: f64,
) -> Result<Observation, EstimationError> {
    if !regressor.needs_load() {
        return Observation::new(robot, regressor, base, samples);
    }
    let equations = |at: Option<&DVector<f64>>| Observation::of_any_length(robot, regressor, base, samples, at);
    let at = at_rest(base, rest, equations)?;
    Observation::checked(robot, regressor, base, samples, Some(&at))
}

fn is_of_load(id: ParameterId) -> bool {
    id.kind.term().is_some_and(|term| term.entry().needs.load)
}

/// The parameters at which the weighted fit of `equations`, linearised at any, comes to rest. Without any, those without friction of the load
/// are fitted.
fn at_rest(
    base: &BaseReduction,
    rest: f64,
    equations: impl Fn(Option<&DVector<f64>>) -> Result<Observation, EstimationError>,
) -> Result<DVector<f64>, EstimationError> {
    let plain = equations(None)?;
    let others: Vec<usize> = (0..base.rank()).filter(|&j| !is_of_load(base.parameters[base.kept[j]])).collect();
    let kept = others.iter().map(|&j| base.kept[j]).collect();
    let less = Observation {
        regressor: plain.regressor.select_columns(&others),
        base: BaseReduction { kept, k: base.k.select_rows(&others), ..base.clone() },
        ..plain.clone()
    };
    let fit = LinearFit::weighted(&Factorisation::new(&less)?)?;
    let mut beta = DVector::zeros(base.rank());
    for (&j, &value) in others.iter().zip(fit.fit.solution().iter()) {
        beta[j] = value;
    }
    let mut change = f64::INFINITY;
    for _ in 0..ROUNDS {
        let observation = equations(Some(&beta))?;
        let next = LinearFit::weighted(&Factorisation::new(&observation)?)?.fit.solution().clone();
        let size = plain.y.norm().max(f64::MIN_POSITIVE);
        change = (&observation.regressor * (&next - &beta)).norm() / size;
        beta = next;
        if change <= rest {
            return Ok(beta);
        }
    }
    Err(EstimationError::LoadNotAtRest { change, rounds: ROUNDS, rest })
}
