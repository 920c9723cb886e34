//! How much of each limit a trajectory uses, and where: the part of a certificate that is computed again before anything
//! moves.
//!
//! Position, velocity, acceleration and jerk are held against their limits at the true extrema of the motion, what the
//! ramps ask and the efforts at the refined peaks of a grid, and clearances by a bound that holds between samples.

use super::clearance::{Scene, WorstClearance, smallest_clearance};
use super::effort::{Channel, EffortModel, WorstEfforts};
use super::limit_kind::LimitKind;
use super::limits::{WorstUse, worst_jerk, worst_use};
use super::path_rows::worst_on_ramps;
use crate::model::Robot;
use crate::trajectory::{PeriodicTrajectory, Quantity, Timeline};

/// Samples of one period on which the search for the smallest clearance begins.
const CLEARANCE_SAMPLES: usize = 1000;

/// Largest use of each kind of limit, 1 at the limit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstLimitUse {
    /// Of half the position range, about its middle.
    pub position: f64,
    /// Of the speed limit.
    pub velocity: f64,
    /// Of the acceleration limit.
    pub acceleration: f64,
    /// Of the jerk limit; `None` where no joint has one.
    pub jerk: Option<f64>,
    /// Of the torque rating over period and ramps, by the nominal parameters and what their uncertainty adds; `None`
    /// without them.
    pub torque: Option<f64>,
    /// Of the torque rating by the nominal parameters alone.
    pub torque_nominal: Option<f64>,
    /// Of the continuous torque by the root mean square over a period; of the rating where none is stated.
    pub torque_rms: Option<f64>,
    /// Of the current limit, as `torque`; `None` where no drive has one.
    pub current: Option<f64>,
    /// Of the continuous current, as `torque_rms`.
    pub current_rms: Option<f64>,
    /// Smallest distance between the robot's shapes and between them and obstacles, m: never undercut at any point.
    /// `None` where no two of them can meet.
    pub clearance_m: Option<f64>,
}

/// The field of each kind of limit.
macro_rules! by_kind {
    ($uses:ty, $value:ty) => {
        impl $uses {
            /// The value for one kind of limit; `None` where nothing has such a limit, and for clearances, which are distances.
            pub const fn for_limit(&self, kind: LimitKind) -> Option<$value> {
                match kind {
                    LimitKind::Position => Some(self.position),
                    LimitKind::Velocity => Some(self.velocity),
                    LimitKind::Acceleration => Some(self.acceleration),
                    LimitKind::Jerk => self.jerk,
                    LimitKind::Torque => self.torque,
                    LimitKind::TorqueRms => self.torque_rms,
                    LimitKind::Current => self.current,
                    LimitKind::CurrentRms => self.current_rms,
                    LimitKind::Clearance => None,
                }
            }
        }
    };
}

by_kind!(WorstLimitUse, f64);
by_kind!(WorstCases, WorstUse);

/// Where each kind of limit is used most. Times below zero are on the ramp in, those beyond the period on the ramp out.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstCases {
    /// Position, rad.
    pub position: WorstUse,
    /// Velocity, rad/s.
    pub velocity: WorstUse,
    /// Acceleration, rad/s².
    pub acceleration: WorstUse,
    /// Jerk, rad/s³.
    pub jerk: Option<WorstUse>,
    /// Torque by the nominal parameters and what their uncertainty adds, N·m.
    pub torque: Option<WorstUse>,
    /// Root mean square of the torque, N·m.
    pub torque_rms: Option<WorstUse>,
    /// Current, A.
    pub current: Option<WorstUse>,
    /// Root mean square of the current, A.
    pub current_rms: Option<WorstUse>,
    /// What comes nearest to what.
    pub clearance: Option<WorstClearance>,
}

/// The largest use of every limit.
pub(crate) struct LimitSurvey {
    /// How much.
    pub(crate) used: WorstLimitUse,
    /// Where.
    pub(crate) worst: WorstCases,
}

impl LimitSurvey {
    /// Of the limits of `robot` by a trajectory of as many joints, over its period and the ramps of `timeline`, with
    /// `samples` of a period; of torque and current where their model is given.
    pub(crate) fn of(
        robot: &Robot,
        trajectory: &PeriodicTrajectory,
        timeline: Timeline,
        samples: usize,
        efforts: Option<&mut EffortModel>,
    ) -> Self {
        let [position, velocity, acceleration] = Quantity::ALL.map(|quantity| worst_use(robot, trajectory, quantity));
        let [ramp_acceleration, ramp_jerk] = worst_on_ramps(robot, trajectory, timeline, samples);
        let acceleration = ramp_acceleration.map_or(acceleration, |ramp| acceleration.worst_of(ramp));
        let jerk = WorstUse::worst_of_both(worst_jerk(robot, trajectory), ramp_jerk);
        let WorstEfforts { torque, current } = efforts.map_or_else(WorstEfforts::default, |model| {
            WorstEfforts::compute(model, &Channel::all(robot), trajectory, timeline, samples)
        });
        let peak = |j: usize| trajectory.curve(j, Quantity::Acceleration).peak();
        let accelerations: Vec<f64> = (0..robot.dof()).map(peak).collect();
        let clearance = smallest_clearance(&mut Scene::new(robot), trajectory, &accelerations, CLEARANCE_SAMPLES);
        Self {
            used: WorstLimitUse {
                position: position.ratio,
                velocity: velocity.ratio,
                acceleration: acceleration.ratio,
                jerk: jerk.map(|worst| worst.ratio),
                torque: torque.map(|used| used.peak.ratio),
                torque_nominal: torque.map(|used| used.nominal),
                torque_rms: torque.map(|used| used.mean_square.ratio),
                current: current.map(|used| used.peak.ratio),
                current_rms: current.map(|used| used.mean_square.ratio),
                clearance_m: clearance.as_ref().map(|nearest| nearest.distance_m),
            },
            worst: WorstCases {
                position,
                velocity,
                acceleration,
                jerk,
                torque: torque.map(|used| used.peak),
                torque_rms: torque.map(|used| used.mean_square),
                current: current.map(|used| used.peak),
                current_rms: current.map(|used| used.mean_square),
                clearance,
            },
        }
    }
}
