//! Motions of one kind whose torque a design is to predict.
//!
//! They come from the generator of the [validation](super::validation) motions with random numbers of their own, so that no design sees
//! what it is scored on.

use super::error::StudyError;
use super::motion_kind::MotionKind;
use super::plan::{ExperimentSettings, ValidationSettings};
use super::validation::ValidationMotions;
use crate::excitation::EvaluationMotions;
use crate::model::{Robot, StandardParameters};
use crate::seed::Seed;

/// Number of motions, as many as there are by default.
const MOTIONS: usize = 20;

/// Draws the motions for a robot, the same for all designs of a study or command with this seed.
///
/// # Errors
/// [`StudyError`] where no draw is inside the robot's limits.
pub fn motions_to_predict(
    kind: MotionKind,
    robot: &Robot,
    nominal: &StandardParameters,
    experiment: &ExperimentSettings,
    seed: Seed,
) -> Result<EvaluationMotions, StudyError> {
    let settings = ValidationSettings { trajectories: 1, samples: 1, measured: MOTIONS, measured_on: kind };
    let seed = seed.child("motions to predict", 0);
    let drawn = ValidationMotions::draw(robot, nominal, experiment, &settings, seed)?;
    Ok(EvaluationMotions::new(drawn.measured, robot.dof())?)
}
