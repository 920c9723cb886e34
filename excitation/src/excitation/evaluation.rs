//! The motions on which an estimate is to predict torque: what I-optimality and the model error are means over.
//!
//! ```text
//! G = (1/(n N)) Σ_k Y_b(k)ᵀ Y_b(k)        n joints, N samples of all motions
//! ```
//! By default, ten of the [first guesses](super::radkhah2007_start) that designs start from, under a seed of their own (period
//! 10 s, five harmonics, each joint at its tightest limit of motion), and the same ten at 30 % of their speed; 50 samples
//! of each; the torque of every joint in N·m counts alike. Joints that a design holds still stand still in them.

use nalgebra::{DMatrix, DVector};

use super::criterion::{Carried, Prediction};
use super::error::{ExcitationError, at_least_one, same_joints};
use super::expected::{EffectTorques, ExpectedEffects};
use super::start::series_start;
use crate::base::BaseReduction;
use crate::dynamics::States;
use crate::model::Robot;
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::trajectory::PeriodicTrajectory;

/// Number of motions of each speed, by default.
const MOTIONS: u64 = 10;

/// Samples of each.
const SAMPLES: usize = 50;

/// Part of the speed in the slow half.
const SLOW: f64 = 0.3;

/// Period and harmonics.
const PERIOD_S: f64 = 10.0;
const HARMONICS: usize = 5;

/// A declared set of motions.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::chains::planar_2r;
/// use armid::excitation::EvaluationMotions;
/// let motions = EvaluationMotions::default_for(&planar_2r()).unwrap();
/// assert_eq!(EvaluationMotions::default_for(&planar_2r()).unwrap(), motions);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluationMotions {
    motions: Vec<PeriodicTrajectory>,
    /// Joints of each.
    pub(super) joints: usize,
    samples: usize,
}

impl EvaluationMotions {
    /// One period of each of these motions of so many joints.
    ///
    /// # Errors
    /// [`ExcitationError::TooFew`] of none, [`ExcitationError::Joints`] if one is of another number of joints.
    pub fn new(motions: Vec<PeriodicTrajectory>, joints: usize) -> Result<Self, ExcitationError> {
        at_least_one("evaluation motions", motions.len())?;
        motions.iter().try_for_each(|motion| same_joints(motion.dof(), joints))?;
        Ok(Self { motions, joints, samples: SAMPLES })
    }

    /// The default of the module's header.
    ///
    /// # Errors
    /// [`ExcitationError`] if the robot has no joint.
    pub fn default_for(robot: &Robot) -> Result<Self, ExcitationError> {
        let seed = Seed::new(0).child("evaluation motions", 0);
        let mut motions = Vec::new();
        for index in 0..MOTIONS {
            let fast =
                PeriodicTrajectory::from(series_start(robot, PERIOD_S, &vec![HARMONICS; robot.dof()], seed, index)?);
            let slow = fast.at_speed(SLOW);
            motions.extend([fast, slow]);
        }
        Self::new(motions, robot.dof())
    }

    /// The mean square of torque on them: G of [`Prediction`], b × b, for the base columns of `regressor`.
    pub fn gram(&self, robot: &Robot, regressor: &JointTorqueRegressor, base: &BaseReduction) -> DMatrix<f64> {
        self.prediction(robot, regressor, base, &vec![None; robot.dof()], None, 1.0).gram
    }

    /// What a criterion needs of them: of the base columns of `regressor`, with the joints that are frozen where they
    /// stand, after an experiment of so many torque rows.
    pub(super) fn prediction(
        &self,
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        frozen: &[Option<f64>],
        expected: Option<&ExpectedEffects>,
        rows: f64,
    ) -> Prediction {
        let b = base.rank();
        let mut gram = DMatrix::zeros(b, b);
        let mut effects = Vec::new();
        let mut carried: Option<Carried> = None;
        let mut count = 0;
        for motion in &self.motions {
            let states = held(motion.sample(self.samples), frozen);
            let w = base.select_columns(&regressor.stack(&states));
            gram += w.tr_mul(&w);
            count += w.nrows();
            let Some(expected) = expected else { continue };
            let mut torques = EffectTorques::new(robot, expected, self.samples, motion.period_s());
            effects = torques.effects();
            if expected.are_carried {
                let d = torques.evaluate(&states);
                let squares = DVector::from_fn(d.ncols(), |e, _| d.column(e).norm_squared());
                let moments = w.tr_mul(&d);
                carried = Some(match carried {
                    Some(all) => Carried { moments: all.moments + moments, squares: all.squares + squares },
                    None => Carried { moments, squares },
                });
            }
        }
        let per_row = 1.0 / count as f64;
        if let Some(all) = &mut carried {
            all.moments *= per_row;
            all.squares *= per_row;
        }
        Prediction { gram: gram * per_row, rows, effects, carried }
    }
}

/// States with the joints that are frozen where they stand.
fn held(mut states: States, frozen: &[Option<f64>]) -> States {
    let n = states.dof;
    for (joint, place) in frozen.iter().enumerate() {
        let Some(place) = place else { continue };
        for k in 0..states.len() {
            states.q[k * n + joint] = *place;
            states.qd[k * n + joint] = 0.0;
            states.qdd[k * n + joint] = 0.0;
        }
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;

    #[test]
    fn identity_frozen_joints_stand_still_and_others_move_as_before() {
        let motions = EvaluationMotions::default_for(&chains::planar_2r()).unwrap();
        let free = motions.motions[0].sample(5);
        let held = held(free.clone(), &[None, Some(0.25)]);
        for k in 0..5 {
            assert_eq!((held.q(k)[0], held.qd(k)[0], held.qdd(k)[0]), (free.q(k)[0], free.qd(k)[0], free.qdd(k)[0]));
            assert_eq!((held.q(k)[1], held.qd(k)[1], held.qdd(k)[1]), (0.25, 0.0, 0.0));
        }
    }
}
