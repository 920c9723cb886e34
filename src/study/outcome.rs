//! The outcome of one run of a study: small, and enough for every figure.

use super::run_error::RunError;
use super::run_id::RunId;
use super::scorer::Score;
use crate::estimation::Estimate;

/// One run of one design under one condition: the estimate of every estimator, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Outcome {
    /// Index of the design in the study.
    pub design: usize,
    /// Index of the condition in the study.
    pub condition: usize,
    /// Index of the arm's true parameters: 0 is the robot's own, others were drawn.
    pub truth: usize,
    /// Number of the run within the design.
    pub run: u64,
    /// `None` where the run ended as planned, else the reason: a counted row, never a gap.
    pub failure: Option<RunError>,
    /// One entry per estimator, in the order of the plan; empty where the run failed.
    pub estimates: Vec<ScoredEstimate>,
}

/// One estimate with its score.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ScoredEstimate {
    /// Name of the estimator.
    pub estimator: String,
    /// Why it failed, where it did; the vectors are empty then.
    pub failure: Option<RunError>,
    /// Base parameters β̂ (b).
    pub beta: Vec<f64>,
    /// Standard deviations that the estimator states (b).
    pub std: Vec<f64>,
    /// Half widths of the 95 % intervals that it states (b).
    pub half_width: Vec<f64>,
    /// RMS residual of each joint, N·m.
    pub residual_rms: Vec<f64>,
    /// Its errors against the truth.
    pub score: Option<Score>,
}

impl Outcome {
    /// The run that it belongs to.
    pub const fn id(&self) -> RunId {
        RunId { design: self.design, condition: self.condition, run: self.run }
    }

    /// `ok`, or the kind of failure that ended the run.
    pub fn status(&self) -> &'static str {
        self.failure.as_ref().map_or("ok", |failure| failure.kind.name())
    }
}

impl ScoredEstimate {
    /// An estimate and its score.
    pub fn new(estimate: &Estimate, score: Score) -> Self {
        Self {
            estimator: estimate.estimator.clone(),
            failure: None,
            beta: estimate.beta().as_slice().to_vec(),
            std: estimate.std().as_slice().to_vec(),
            half_width: estimate.half_width().as_slice().to_vec(),
            residual_rms: estimate.residual_rms.clone(),
            score: Some(score),
        }
    }

    /// An estimator that gave no estimate, and why.
    pub fn failed(estimator: &str, failure: RunError) -> Self {
        Self { estimator: estimator.to_owned(), failure: Some(failure), ..Self::default() }
    }
}
