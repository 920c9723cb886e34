//! The motions on which a study tests predictions of torque: four kinds, all inside the ratings of the robot.
//!
//! ```text
//! random            Fourier series whose amplitudes bring each joint to its tightest limit of motion
//! slow              q_s(t) = q(0.3 t):  q the same, q̇ times 0.3, q̈ times 0.09
//! point to point    minimum jerk between two random poses, at rest at both ends
//! static            random poses at rest: q̇ = q̈ = 0
//! ```
//! No estimate is fitted to them, and none is a design: their random numbers come from the study's seed under purposes of
//! their own. The random motions are drawn by the rule of the designs' first guesses; I-optimal designs, which minimise the
//! error on such motions and on slow ones, are made for another draw of the same two kinds. The moves and the poses come
//! from a generator that no family of designs and no criterion has.
//!
//! All are inside the limits of position, speed and acceleration, and inside the torque ratings by the nominal parameters:
//! peaks within the rating, the root mean square within the continuous torque, a pose at rest within both. The rules:
//! - A random motion that exceeds a torque rating, at its own speed or as the slow one, is drawn again. Where 20 draws do,
//!   the amplitudes of each further draw are 5 % smaller than those of the draw before it, about the same mean pose.
//! - A pose where a joint cannot carry the arm at rest is drawn again, as an end of a move too.
//! - A move uses 90 % of the limit that binds first: where that is a torque rating, it is slowed down in steps of 5 %, and
//!   drawn again where no speed keeps it, because gravity on the way does not.
//!
//! Torque is looked at on a grid, and held to 99 % of its ratings (90 % of a move): the rest is left to the instants between. A
//! robot that states no ratings has none to keep. Plans state no torque limits of their own: the robot's count.
//!
//! At rest the signs of Coulomb friction, of its load dependence and of its static part are sign(0) = 0, and so are their
//! smooth forms: what is predicted there is gravity, and what else depends on position alone (springs, constant offsets).
//! Friction, rotor and link inertia do not enter. A real arm at rest holds part of its weight by friction of unknown sign,
//! which no prediction can know.

use rand::RngExt;

use super::motion_kind::MotionKind;
use super::plan::{ExperimentSettings, ValidationSettings};
use super::point_to_point::PointToPointMove;
use super::torque_rating::TorqueRating;
use crate::dynamics::States;
use crate::excitation::{ExcitationError, radkhah2007_start};
use crate::model::{Robot, StandardParameters};
use crate::seed::{Seed, Stream};
use crate::trajectory::PeriodicTrajectory;

/// Speed of the slow motions over that of the random ones.
pub(super) const SLOW: f64 = 0.3;

/// Samples of a motion on which its torque is looked at.
const GRID: usize = 500;

/// Share of a torque rating that a random motion and a pose use at most.
const SHARE: f64 = 0.99;

/// Share of every limit that a move uses at most.
const MOVE_SHARE: f64 = 0.9;

/// Samples of a move on which its torque is looked at.
const MOVE_GRID: usize = 100;

/// A move is slowed down in steps of this factor, so often at most: to 0.3 % of its speed.
const MOVE_STEP: f64 = 1.05;
const MOVE_STEPS: u32 = 120;

/// Draws of a random motion with full amplitudes.
const FULL_DRAWS: u64 = 20;

/// Draws of anything.
const DRAWS: u64 = 100;

/// Draws of a pose, each of which takes a single state.
const POSE_DRAWS: u64 = 10_000;

/// What a further draw's amplitudes are multiplied with.
const SMALLER: f64 = 0.95;

/// The validation motions of a study.
///
/// `trajectories` of each kind with `samples` states each; of the poses as many as of states of another kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ValidationMotions {
    /// The random trajectories.
    pub random: Vec<PeriodicTrajectory>,
    /// The moves from point to point.
    pub moves: Vec<PointToPointMove>,
    /// The motions that an arm performs beside its runs: random ones, the same slowly, or moves there and back.
    pub measured: Vec<PeriodicTrajectory>,
    poses: Vec<States>,
    /// Random motions that predictions are tested on; the arm may perform more.
    tested: usize,
    samples: usize,
}

/// Why validation motions cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ValidationError {
    /// A random trajectory cannot be made.
    #[error(transparent)]
    Trajectory(#[from] ExcitationError),
    /// No draw is inside the torque ratings.
    #[error(
        "none of {draws} draws of a {} validation motion is inside the torque ratings by the nominal parameters, expected \
         ratings that carry the arm at rest", kind.title()
    )]
    Rating { kind: MotionKind, draws: u64 },
}

impl ValidationMotions {
    /// Draws the motions of a plan for a robot; `seed` is the study's.
    ///
    /// # Errors
    /// [`ValidationError`] where the settings are impossible for the robot, or it cannot carry itself by its ratings.
    pub fn draw(
        robot: &Robot,
        nominal: &StandardParameters,
        experiment: &ExperimentSettings,
        settings: &ValidationSettings,
        seed: Seed,
    ) -> Result<Self, ValidationError> {
        let mut rating = TorqueRating::new(robot, nominal);
        let (tested, samples) = (settings.trajectories, settings.samples);
        let most = tested.max(settings.measured);
        let random = (0..most as u64)
            .map(|index| random_motion(robot, &mut rating, experiment, seed, index))
            .collect::<Result<Vec<_>, _>>()?;
        let moves = (0..if settings.measured_on == MotionKind::PointToPoint { most } else { tested } as u64)
            .map(|index| point_to_point(robot, &mut rating, &mut seed.stream("validation move", index)))
            .collect::<Result<Vec<_>, _>>()?;
        let poses = (0..tested as u64)
            .map(|index| static_poses(robot, &mut rating, samples, &mut seed.stream("validation pose", index)))
            .collect::<Result<Vec<_>, _>>()?;
        // Many divisors, so that a period of any length gives equally many equations.
        let step_s = GRID as f64 / experiment.rate_hz;
        let whole = |duration_s: f64| step_s * (duration_s / step_s).ceil();
        let mut measured: Vec<PeriodicTrajectory> = match settings.measured_on {
            MotionKind::Random | MotionKind::Static => random.clone(),
            MotionKind::Slow => {
                random.iter().map(|of| of.at_speed(of.period_s() / whole(of.period_s() / SLOW))).collect()
            }
            MotionKind::PointToPoint => moves.iter().map(|made| made.there_and_back(robot, whole)).collect(),
        };
        measured.truncate(settings.measured);
        Ok(Self { random, moves, measured, poses, tested, samples })
    }

    /// The states of one kind on which predictions are tested, motion by motion.
    pub fn states(&self, kind: MotionKind) -> Vec<States> {
        let random = || self.random[..self.tested].iter().map(|motion| motion.sample(self.samples));
        match kind {
            MotionKind::Random => random().collect(),
            MotionKind::Slow => random().map(slowed).collect(),
            MotionKind::PointToPoint => self.moves.iter().map(|made| made.sample(self.samples)).collect(),
            MotionKind::Static => self.poses.clone(),
        }
    }
}

/// The states of the same path at the speed of slow motions.
fn slowed(states: States) -> States {
    States {
        qd: states.qd.iter().map(|speed| SLOW * speed).collect(),
        qdd: states.qdd.iter().map(|acceleration| SLOW * SLOW * acceleration).collect(),
        ..states
    }
}

/// The first draw of a random trajectory that is inside the torque ratings at both of its speeds.
fn random_motion(
    robot: &Robot,
    rating: &mut TorqueRating,
    experiment: &ExperimentSettings,
    seed: Seed,
    index: u64,
) -> Result<PeriodicTrajectory, ValidationError> {
    let mut amplitude = 1.0;
    for draw in 0..DRAWS {
        let seed = seed.child("validation", draw);
        let mut motion: PeriodicTrajectory =
            radkhah2007_start(robot, experiment.period_s, experiment.harmonics, seed, index)?.into();
        if draw >= FULL_DRAWS {
            amplitude *= SMALLER;
            (0..motion.dof()).for_each(|joint| motion.adjust(joint, amplitude, 0.0));
        }
        let states = motion.sample(GRID);
        if rating.holds(&states, SHARE) && rating.holds(&slowed(states), SHARE) {
            return Ok(motion);
        }
    }
    Err(ValidationError::Rating { kind: MotionKind::Random, draws: DRAWS })
}

/// The first draw of a move that is inside the torque ratings at some speed.
fn point_to_point(
    robot: &Robot,
    rating: &mut TorqueRating,
    stream: &mut Stream,
) -> Result<PointToPointMove, ValidationError> {
    let kind = MotionKind::PointToPoint;
    for _ in 0..DRAWS {
        let from = pose(robot, rating, MOVE_SHARE, kind, stream)?;
        let to = pose(robot, rating, MOVE_SHARE, kind, stream)?;
        let fastest = PointToPointMove::within_limits(robot, from, to, MOVE_SHARE);
        let mut factor = 1.0;
        for _ in 0..MOVE_STEPS {
            let made = fastest.slowed(factor);
            if rating.holds(&made.sample(MOVE_GRID), MOVE_SHARE) {
                return Ok(made);
            }
            factor *= MOVE_STEP;
        }
    }
    Err(ValidationError::Rating { kind, draws: DRAWS })
}

/// So many random poses at rest.
fn static_poses(
    robot: &Robot,
    rating: &mut TorqueRating,
    count: usize,
    stream: &mut Stream,
) -> Result<States, ValidationError> {
    let rest = vec![0.0; robot.dof()];
    let mut states = States::new(robot.dof());
    for _ in 0..count {
        states.push(&pose(robot, rating, SHARE, MotionKind::Static, stream)?, &rest, &rest);
    }
    Ok(states)
}

/// The first draw of a pose, evenly from the position limits, at which the arm can rest. Where a limit is not stated, half a
/// turn (π m) from the other, or a whole turn about zero, stands for it.
fn pose(
    robot: &Robot,
    rating: &mut TorqueRating,
    share: f64,
    kind: MotionKind,
    stream: &mut Stream,
) -> Result<Vec<f64>, ValidationError> {
    let half_turn = std::f64::consts::PI;
    for _ in 0..POSE_DRAWS {
        let place = |joint: &crate::model::Joint| {
            let (low, high) = match joint.limits.position {
                (low, high) if low.is_finite() && high.is_finite() => (low, high),
                (low, _) if low.is_finite() => (low, low + half_turn),
                (_, high) if high.is_finite() => (high - half_turn, high),
                (_, _) => (-half_turn, half_turn),
            };
            let part: f64 = stream.random();
            low + part * (high - low)
        };
        let found: Vec<f64> = robot.joints().iter().map(place).collect();
        if rating.holds_at_rest(&found, share) {
            return Ok(found);
        }
    }
    Err(ValidationError::Rating { kind, draws: POSE_DRAWS })
}
