//! What advice says.

use std::path::PathBuf;

use armid::model::DriveKind;
use armid::statistics::{Interval, Spread};
use armid::study::Purpose;

/// A design with an estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// Name of the design's criterion.
    pub design: String,
    /// Name of the estimator, and the terms that it has beside the usual ones: `wls+stribeck`.
    pub estimator: String,
    /// The columns that it estimates.
    pub columns: String,
    /// What to expect of its error: the mean over levels of the effects, and of arms the geometric mean of theirs.
    pub expected: f64,
    /// Share of the runs in which its error is at most a tenth above that of the best candidate there.
    pub near_best: f64,
    /// Runs in which it gave no estimate. Of an estimator with more terms, the error there is that of the same one without them.
    pub failed: usize,
    /// Its error over all arms and levels of the effects: 90 % of them are between `low` and `high`.
    pub error: Spread,
    /// What to expect over that of the best candidate on the same arms, with a 95 % interval by Student's t over arms.
    /// Of the best itself, and of fewer than two arms, `None`. Not adjusted for the number of candidates.
    pub over_best: Option<Interval>,
    /// The error at each level, over arms.
    pub by_level: Vec<(String, Spread)>,
}

impl Candidate {
    /// Whether the runs do not tell it from the best candidate.
    pub fn is_like_the_best(&self) -> bool {
        self.over_best.is_some_and(|ratio| ratio.contains(1.0))
    }
}

/// What more time on the robot would give.
///
/// ```text
/// E'² = E² − n² (1 − T/(T + more))        n the error of arms without effects, which noise alone makes
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Longer {
    /// How much more, min.
    pub minutes: f64,
    /// The error to expect then.
    pub expected: f64,
    /// What no more time would take away of it.
    pub floor: f64,
}

/// A base parameter that the best candidate does not determine, and how long would: noise falls with the root of time.
///
/// ```text
/// T' = T (3 σ / |β|)²        σ the stated standard deviation after T
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Undetermined {
    /// Its name.
    pub name: String,
    /// Minutes with the motion that is advised; `None` of a parameter that is zero.
    pub minutes: Option<f64>,
    /// Another motion that takes less time, and how long.
    pub other: Option<(String, f64)>,
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
    /// What was taken from an earlier log, a sentence each.
    pub from_log: Vec<String>,
    /// What an hour more would give, by the runs of the best candidate.
    pub longer: Option<Longer>,
    /// All candidates, the best first: those with the fewest runs without any estimate, and of them that which is near the best in most runs.
    pub candidates: Vec<Candidate>,
    /// Base parameters that the best candidate does not determine to within a third of their value.
    pub poorly_determined: Vec<Undetermined>,
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
