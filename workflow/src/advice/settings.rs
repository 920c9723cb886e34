//! What advice is asked for.

use std::path::PathBuf;

use armid::model::DriveKind;
use armid::model::format::ChainEnds;
use armid::study::{AdvicePlan, Purpose};

use super::earlier_log::EarlierLog;

/// Which arm, what is known of it, and what its model is for.
#[derive(Clone, Debug)]
pub struct AdviceSettings {
    /// A bundled name, or the path of a robot file, URDF or MJCF.
    pub robot: String,
    /// Which chain of a tree.
    pub ends: ChainEnds,
    /// The drives; those of the robot file where `None`, and harmonic where it states none.
    pub drive: Option<DriveKind>,
    /// What an earlier log of the arm shows, instead of what is assumed.
    pub log: Option<EarlierLog>,
    /// What the model is for.
    pub purpose: Purpose,
    /// Time on the robot, minutes.
    pub minutes: f64,
    /// Arms that are drawn around the nominal one.
    pub arms: usize,
    /// Every random number comes from it.
    pub seed: u64,
    /// The folder of study, page, motion and experiment.
    pub output: PathBuf,
    /// Threads; all cores where 0.
    pub threads: usize,
    /// Goes on with finished work in the folder.
    pub resume: bool,
}

impl AdviceSettings {
    /// The settings for a robot, with the defaults of the command.
    pub fn new(robot: impl Into<String>, output: impl Into<PathBuf>) -> Self {
        Self {
            robot: robot.into(),
            ends: ChainEnds::default(),
            drive: None,
            log: None,
            purpose: Purpose::Torque,
            minutes: 1.0,
            arms: 6,
            seed: 1,
            output: output.into(),
            threads: 0,
            resume: false,
        }
    }

    /// Recorded periods in the time on the robot, at least two.
    pub(super) fn periods(&self) -> usize {
        let whole = (60.0 * self.minutes / AdvicePlan::PERIOD_S).round() as usize;
        whole.saturating_sub(AdvicePlan::DISCARDED_PERIODS).max(2)
    }
}
