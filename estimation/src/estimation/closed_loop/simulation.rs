//! The arm under its known servo, simulated for any parameters.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::error::ClosedLoopError;
use crate::dynamics::States;
use crate::estimation::position_servo::PositionServo;
use crate::experiment::{ExperimentPlan, Recording};
use crate::model::{ParameterId, Robot, StandardParameters};
use crate::observer::Observer;
use crate::signal::Samples;

/// What an arm with certain parameters does under its servo, at the instants of the samples: N × n each.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoopMotion {
    /// Positions, velocities, accelerations, without any sensor.
    pub states: States,
    /// Torque of the motors on the joints, mean of what is held before and after the instant, N·m (N), row-major.
    /// `τ = Y(q, q̇, q̈) φ` holds at every instant where the motion repeats from period to period.
    pub tau: Vec<f64>,
}

/// How positions and torque move with parameters: means over blocks of samples, (n·M) × d each, row `k n + i` that of joint i
/// in block k.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoopSlopes {
    /// `∂q/∂φ_j`.
    pub q: DMatrix<f64>,
    /// `∂τ/∂φ_j`.
    pub tau: DMatrix<f64>,
}

/// The closed loop of an arm along the motions of its recordings, for any parameters: the same controller, the same
/// reference, the same start from rest; no sensors.
///
/// The simulated motion stands beside the samples instant by instant: of a recording with periods it is the mean over the
/// recorded ones, and several recordings follow each other. Equal parameters give equal bits.
///
/// Estimators that simulate receive it in their problem
/// ([`EstimationProblem::closed_loop`](crate::estimation::EstimationProblem::closed_loop)); the core has no
/// simulator, `armid-sim` brings one.
pub trait ClosedLoop: fmt::Debug + Send + Sync {
    /// What the servo's gains are placed on, and what parameters that torque does not show are taken from.
    fn nominal(&self) -> &StandardParameters;

    /// The motion with these parameters. An observer may end it at any sample.
    ///
    /// # Errors
    /// [`ClosedLoopError::MassMatrix`] or [`ClosedLoopError::Diverged`] where there is none, [`ClosedLoopError::Interrupted`].
    fn motion(
        &self,
        parameters: &StandardParameters,
        observer: &dyn Observer,
    ) -> Result<ClosedLoopMotion, ClosedLoopError>;

    /// The motion with its derivatives by some parameters (d of them) as means over blocks of `block` samples: those of the
    /// simulation itself, exact but for rounding.
    ///
    /// # Errors
    /// As [`ClosedLoop::motion`].
    fn slopes(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError>;

    /// This loop as one of joints that were commanded positions; `None` of a servo of armid's own.
    fn commanded(&self) -> Option<&dyn CommandedLoop> {
        None
    }

    /// This loop in intervals, for multiple shooting; `None` where it can begin from rest alone.
    fn in_intervals(&self) -> Option<&dyn ClosedLoopIntervals> {
        None
    }
}

/// A closed loop along the commands of logs, by position servos of which numbers may be guesses.
pub trait CommandedLoop {
    /// The servos, with what is not known of them.
    fn servo(&self) -> &PositionServo;

    /// The measured states in which the logs begin: of each log n positions and n velocities.
    fn starts(&self) -> Vec<f64>;

    /// As [`ClosedLoop::slopes`], by other numbers of the servos and from other states. Derivatives are those by `by`, by what is unknown of
    /// the servos, and by the states, in that order. Positions and states are those of the samples: another zero turns the arm, not them.
    ///
    /// # Errors
    /// As [`ClosedLoop::motion`].
    fn slopes_from(
        &self,
        parameters: &StandardParameters,
        servo: &PositionServo,
        starts: &[f64],
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError>;
}

/// Where an interval of the closed loop begins.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoopNode {
    /// Blocks of samples that the interval covers, counted over all recordings; the node lies one sample before them.
    pub blocks: Range<usize>,
    /// Whether the interval before ends here; it is of another recording, or there is none, where not.
    pub follows: bool,
    /// Positions, velocities, then what the servo remembers: s numbers, groups of n.
    pub state: DVector<f64>,
}

/// The closed loop from one node to the next, with its derivatives by d parameters and the s numbers of the node's state, in
/// that order.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoopInterval {
    /// Means of positions and of torque over blocks, n·m each.
    pub q: Vec<f64>,
    /// As [`ClosedLoopMotion::tau`].
    pub tau: Vec<f64>,
    /// Their derivatives, (n·m) × (d + s) each.
    pub slopes: ClosedLoopSlopes,
    /// The state one sample before the interval ends, s.
    pub end: DVector<f64>,
    /// Its derivatives, s × (d + s).
    pub end_slopes: DMatrix<f64>,
}

/// A closed loop that can begin in any state.
pub trait ClosedLoopIntervals {
    /// Nodes so many blocks of `block` samples apart, along `states`, where the motors exert the mean of `tau`
    /// (N × n, row-major), whatever the parameters. The first block of each recording is in no interval.
    fn nodes(&self, states: &States, tau: &[f64], block: usize, apart: usize) -> Vec<ClosedLoopNode>;

    /// The motion from each of these nodes.
    ///
    /// # Errors
    /// As [`ClosedLoop::motion`], with the time at which an interval runs away.
    fn intervals(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        nodes: &[ClosedLoopNode],
        observer: &dyn Observer,
    ) -> Result<Vec<ClosedLoopInterval>, ClosedLoopError>;
}

/// What a closed loop follows.
#[derive(Clone, Copy, Debug)]
pub enum ClosedLoopReference<'a> {
    /// Motions of plans, by the servo of the robot file with gains for nominal parameters.
    Plans(&'a [ExperimentPlan]),
    /// Commands of logs, by the position servos that made the torque of their samples.
    Commands(&'a PositionServo, &'a [Samples]),
}

/// Makes the closed loop of a robot.
pub type ClosedLoopFactory =
    fn(&Robot, &StandardParameters, ClosedLoopReference<'_>) -> Result<Arc<dyn ClosedLoop>, ClosedLoopError>;

/// The closed loop in which recordings were made, `None` for a log of something else.
///
/// # Errors
/// [`ClosedLoopError`] with what is not known of it.
pub fn closed_loop_of(
    factory: Option<ClosedLoopFactory>,
    robot: &Robot,
    nominal: Option<&StandardParameters>,
    recordings: &[Option<&Recording>],
) -> Result<Arc<dyn ClosedLoop>, ClosedLoopError> {
    let factory = factory.ok_or(ClosedLoopError::NotGiven)?;
    let name = || robot.name().to_owned();
    if robot.stated_servo().is_none() {
        return Err(ClosedLoopError::NoServo { robot: name() });
    }
    let nominal = nominal.ok_or_else(|| ClosedLoopError::NoNominal { robot: name() })?;
    let plans: Option<Vec<ExperimentPlan>> = recordings.iter().map(|recording| Some((*recording)?.plan())).collect();
    let plans = plans.filter(|plans| !plans.is_empty()).ok_or(ClosedLoopError::NoReference)?;
    factory(robot, nominal, ClosedLoopReference::Plans(&plans))
}

/// The closed loop of a log of commanded positions.
///
/// # Errors
/// As [`closed_loop_of`].
pub fn commanded_loop_of(
    factory: Option<ClosedLoopFactory>,
    robot: &Robot,
    nominal: Option<&StandardParameters>,
    servo: &PositionServo,
    samples: &[Samples],
) -> Result<Arc<dyn ClosedLoop>, ClosedLoopError> {
    let factory = factory.ok_or(ClosedLoopError::NotGiven)?;
    let nominal = nominal.ok_or_else(|| ClosedLoopError::NoNominal { robot: robot.name().to_owned() })?;
    factory(robot, nominal, ClosedLoopReference::Commands(servo, samples))
}
