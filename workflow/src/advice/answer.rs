//! What advice says.

use std::path::PathBuf;

use armid::statistics::{Interval, Spread};
use armid::study::{DriveKind, Purpose};

/// A design with an estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// Name of the design's criterion.
    pub design: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Its error over all arms and levels of the effects: 90 % of them are between `low` and `high`.
    pub error: Spread,
    /// Its error over that of the best candidate on the same arms, with a 95 % interval by Student's t over arms: each arm counts by the
    /// mean logarithm over levels. Of the best itself, and of fewer than two arms, `None`. Not adjusted for the number of candidates.
    pub over_best: Option<Interval>,
    /// The error at each level.
    pub by_level: Vec<(String, Spread)>,
}

impl Candidate {
    /// Whether the runs do not tell it from the best candidate.
    pub fn is_like_the_best(&self) -> bool {
        self.over_best.is_some_and(|ratio| ratio.contains(1.0))
    }
}

/// The best motion and estimator for an arm, and what to expect of them.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct AdviceAnswer {
    /// Name of the robot.
    pub robot: String,
    /// The drives that were assumed.
    pub drive: DriveKind,
    /// What the model is for.
    pub purpose: Purpose,
    /// Recorded time, s.
    pub duration_s: f64,
    /// All candidates, the best first.
    pub candidates: Vec<Candidate>,
    /// Base parameters that the best candidate does not determine to within a third of their value.
    pub poorly_determined: Vec<String>,
    /// How many base parameters there are.
    pub parameters: usize,
    /// Whether the motion keeps all limits.
    pub limits_kept: bool,
    /// What was assumed of the robot, a sentence each.
    pub assumptions: Vec<String>,
    /// The motion.
    pub trajectory: PathBuf,
    /// The experiment that performs it.
    pub experiment: PathBuf,
    /// The page of the study.
    pub report: Option<PathBuf>,
    /// Runs of the study.
    pub runs: usize,
    /// Those that gave no estimate.
    pub failed: usize,
}
