//! Mistakes that logs seem to have been made with.

use armid::diagnosis::{Evidence, Mistake, Suspicion, diagnose, standing_joints};
use armid::model::Columns;
use armid::signal::Samples;

use super::log_identification::shows_every_joint;
use super::processed_log::ProcessedLog;
use crate::error::Error;

impl ProcessedLog {
    /// Mistakes that the logs seem to have been made with, or in the robot file; none for recordings of armid's own.
    ///
    /// # Errors
    /// [`Error`] where the robot has no base parameters of these columns.
    pub fn suspicions(&self, columns: Columns) -> Result<Vec<Suspicion>, Error> {
        if !self.is_foreign() {
            return Ok(Vec::new());
        }
        let standing = standing_joints(&self.samples);
        if !standing.is_empty() {
            let at_rest = |joint| Suspicion { mistake: Mistake::AtRest { joint }, cost: 0.0, corrected_cost: 0.0 };
            return Ok(standing.into_iter().map(at_rest).collect());
        }
        // A log in which a joint rests or has no torque says too little of the others to find a mistake in it.
        let parts: Vec<Samples> = self.parts.iter().filter(|part| shows_every_joint(part)).cloned().collect();
        let Ok(samples) = Samples::join(parts) else { return Ok(Vec::new()) };
        let held_out = self.held_out.iter().find(|part| shows_every_joint(part));
        let log = Evidence { samples: &samples, held_out, nominal: self.robot.guess() };
        let found = diagnose(&self.robot.robot, columns, &log);
        Ok(found.map_err(|error| Error::new(format!("{}: {error}", self.name())))?.into_iter().collect())
    }
}
