//! From a robot to its base parameters.

use nalgebra::DMatrix;

use super::error::BaseError;
use super::geometry::Geometry;
use super::method::Method;
use super::radkhah2007::Radkhah2007Sets;
use super::random_states::LEAST_STATES;
use super::reduction::BaseReduction;
use super::scaled_stack::scaled_stack;
use super::structural::BaseMotion;
use super::{dependence, structural};
use crate::dynamics::States;
use crate::model::{Columns, ParameterId, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;

/// The base parameters of a robot under motions of every kind.
///
/// [`Method::Radkhah2007`] and [`Method::Qr`] draw random states from `seed`; [`Method::Structural`] needs none. All three
/// give the same kept columns and, to rounding, the same K. Columns that no torque sensor could tell from the others are then
/// left out, the same for every method and seed ([`NearlyDependent`](super::NearlyDependent)); [`structural_base`] keeps them.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::base::{Method, reduce};
/// use armid::model::Columns;
/// use armid::seed::Seed;
/// # let robot = armid::chains::planar_2r();
/// let base = reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(1))?;
/// let qr = reduce(&robot, Columns::RIGID, Method::Qr, Seed::new(1))?;
/// assert_eq!(base.names(), qr.names());
/// assert!((&base.k - &qr.k).amax() < 1e-9);
/// # Ok::<(), armid::base::BaseError>(())
/// ```
///
/// # Errors
/// [`BaseError::NotFinite`] if the robot's geometry is not finite. Except with [`Method::Structural`],
/// [`BaseError::Columns`] if a column depends on load or temperature.
pub fn reduce(robot: &Robot, columns: Columns, method: Method, seed: Seed) -> Result<BaseReduction, BaseError> {
    let whole = structural_base(robot, columns, method, seed)?;
    dependence::leave_out(robot, &Geometry::of(robot), columns, whole)
}

/// The base parameters that structure reveals, however little: a column stands in the base if it differs from the others
/// by more than rounding.
///
/// # Errors
/// As [`reduce`].
pub fn structural_base(
    robot: &Robot,
    columns: Columns,
    method: Method,
    seed: Seed,
) -> Result<BaseReduction, BaseError> {
    let geometry = Geometry::of(robot);
    let parameters = columns.parameters(robot);
    if method == Method::Structural {
        return Ok(structural::reduce(&geometry, &parameters, BaseMotion::Fixed));
    }
    columns.check_motion()?;
    let states = geometry.random_states(parameters.len(), &mut seed.stream("base reduction", 0));
    reduce_on(robot, columns, method, &states)
}

/// The base parameters of a robot whose base moves in a known way.
///
/// The joints' efforts are measured, the force that moves the base is not. Gravity turns as the base does. On the A460 with a base that
/// moves in all six directions the rank is 42, not the 45 that `radkhah2007` hopes for: `m1` and `mcy1` stay invisible, and `Ixx1` and
/// `Izz1` show only as a difference.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_with_base(
    robot: &Robot,
    columns: Columns,
    motion: BaseMotion,
    method: Method,
    seed: Seed,
) -> Result<BaseReduction, BaseError> {
    let geometry = Geometry::of(robot);
    let parameters = columns.parameters(robot);
    if method == Method::Structural {
        return Ok(structural::reduce(&geometry, &parameters, motion));
    }
    let regressor = JointTorqueRegressor::new(robot, columns)?;
    let mut rng = seed.stream("base reduction with a moving base", 0);
    let states = geometry.random_states(parameters.len(), &mut rng);
    let (n, p) = (regressor.rows(), regressor.cols());
    let mut rows = vec![0.0; states.len() * n * p];
    for (k, out) in rows.chunks_exact_mut(n * p).enumerate() {
        let base = geometry.random_base_state(motion, &robot.gravity(), &mut rng);
        regressor.with_base_motion(&base, states.q(k), states.qd(k), states.qdd(k), out);
    }
    let w = DMatrix::from_row_slice(states.len() * n, p, &rows);
    Ok(BaseReduction { base_motion: motion, ..reduce_stack(&geometry, &parameters, w, method)? })
}

/// The base parameters that a given motion reveals: a category can only fall against [`reduce`], never rise.
///
/// `states` are the samples of one trajectory, at least ten (`radkhah2007`'s N); `method` is [`Method::Radkhah2007`] or
/// [`Method::Qr`]. Coulomb columns use each drive's own smooth sign.
///
/// # Errors
/// [`BaseError::NoTrajectory`] for [`Method::Structural`], [`BaseError::Dof`] for states of another robot,
/// [`BaseError::TooFewSamples`], [`BaseError::Columns`] if a column depends on load or temperature, and
/// [`BaseError::NotFinite`] for states that are not finite.
pub fn reduce_on(robot: &Robot, columns: Columns, method: Method, states: &States) -> Result<BaseReduction, BaseError> {
    let regressor = JointTorqueRegressor::new(robot, columns)?;
    if states.dof != robot.dof() {
        return Err(BaseError::Dof { robot: robot.name().to_owned(), found: states.dof, expected: robot.dof() });
    }
    if states.len() < LEAST_STATES {
        return Err(BaseError::TooFewSamples { found: states.len(), expected: LEAST_STATES });
    }
    let w = regressor.stack(states);
    reduce_stack(&Geometry::of(robot), &columns.parameters(robot), w, method)
}

/// The reduction of a stacked regressor, whose row `k n + i` is joint i, in SI units.
fn reduce_stack(
    geometry: &Geometry,
    parameters: &[ParameterId],
    w: DMatrix<f64>,
    method: Method,
) -> Result<BaseReduction, BaseError> {
    let w = scaled_stack(geometry, parameters, w)?;
    let reduction = match method {
        Method::Radkhah2007 => Radkhah2007Sets::from_regressor(&w).reduction(parameters),
        Method::Qr => BaseReduction::from_stack(parameters, &w, Method::Qr),
        Method::Structural => return Err(BaseError::NoTrajectory { method }),
    };
    Ok(reduction.with_units(&geometry.units(parameters)))
}
