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

use super::error::EstimationError;
use super::factorisation::Factorisation;
use super::linear_fit::LinearFit;
use super::observation::Observation;
use crate::base::BaseReduction;
use crate::model::{ParameterId, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// Rounds until the fit must rest.
const ROUNDS: usize = 60;
/// Change of β with which it rests, in standard deviations, root mean square over β.
const REST: f64 = 0.02;
/// Change of β with which it rests where a term is only tested, in standard deviations.
pub(super) const REST_OF_TESTS: f64 = 1.0;
/// Change of the torque, as a part of the measured one, with which it rests whatever the standard deviations are.
const ROUNDING: f64 = 1e-9;
/// Least part of a step that is taken.
const LEAST_PART: f64 = 1.0 / 16.0;

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

/// The equations of samples, friction of the load being at rest with this change of β, in standard deviations.
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
    let (plain, left_out) = Observation::stacked(robot, regressor, base, samples, None)?;
    // What is not shown needs no rounds to say so; friction of the load is looked at where the fit rests.
    plain.check_shown(&left_out, |id| !is_of_load(id))?;
    let equations = |at: &DVector<f64>| Ok(Observation::stacked(robot, regressor, base, samples, Some(at))?.0);
    let at = at_rest(plain, rest, equations)?;
    Observation::checked(robot, regressor, base, samples, Some(&at))
}

fn is_of_load(id: ParameterId) -> bool {
    id.kind.term().is_some_and(|term| term.entry().needs.load)
}

/// The parameters at which the weighted fit of `equations`, linearised at any, comes to rest. Of the `plain` ones, those without friction of
/// the load are fitted first.
fn at_rest(
    plain: Observation,
    rest: f64,
    equations: impl Fn(&DVector<f64>) -> Result<Observation, EstimationError>,
) -> Result<DVector<f64>, EstimationError> {
    let base = &plain.base.clone();
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
    let (mut change, mut last, mut part) = (f64::INFINITY, f64::INFINITY, 1.0_f64);
    for _ in 0..ROUNDS {
        let observation = equations(&beta)?;
        let found = LinearFit::weighted(&Factorisation::new(&observation)?)?;
        let step = found.fit.solution() - &beta;
        let torque = &observation.regressor * &step;
        let size = torque.norm() / plain.y.norm().max(f64::MIN_POSITIVE);
        let white = |of| observation.white(&of, &torque).map(|white| white.norm());
        let white = found.weights.map_or(Ok(f64::INFINITY), white)?;
        change = white / (base.rank().max(1) as f64).sqrt();
        if change <= rest || size <= ROUNDING {
            return Ok(beta + step);
        }
        // |τ_l| has a kink, and the residual is not small: whole steps may go round in circles. A part of a linear step leaves 1 − part of the
        // change; where less than half of that is gained, the next is half as long, and where three quarters are, twice. Standard deviations
        // cannot tell: those of an exact log shrink with the change.
        if size > (1.0 - 0.5 * part) * last {
            part = (0.5 * part).max(LEAST_PART);
        } else if size <= (1.0 - 0.75 * part) * last {
            part = (2.0 * part).min(1.0);
        }
        last = size;
        beta += step * part;
    }
    Err(EstimationError::LoadNotAtRest { change, rounds: ROUNDS, rest })
}
