//! What a campaign answers.

use std::path::PathBuf;

use armid::estimation::{Estimate, Finding};
use serde::Serialize;

use super::stopping::{Obstacle, Outcome, Width};
use super::target::Target;

/// A round that is finished.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoundAnswer {
    /// Its number, from one.
    pub number: usize,
    /// How long the arm moved in it, s.
    pub seconds: f64,
    /// How long the arm has moved by its end, s.
    pub total_s: f64,
    /// Factor by which the difference between rounds widens intervals, 1 where they differ no more than their covariances say.
    pub widened_by: f64,
    /// The intervals by all rounds so far, target by target.
    pub widths: Vec<Width>,
}

/// How a campaign stands. It serialises to the keys of the command's answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignAnswer {
    /// Name of the robot.
    pub robot: String,
    /// How it ended, if it did.
    pub outcome: Outcome,
    /// What must be reached.
    pub targets: Vec<Target>,
    /// Unit of each target's quantity.
    pub units: Vec<String>,
    /// Whether the last round met each target.
    pub met: Vec<bool>,
    /// What keeps targets out of reach.
    pub obstacles: Vec<Obstacle>,
    /// Terms that the logs show and that were added to the model, as `--columns` names them.
    pub added_terms: Vec<String>,
    /// The most rounds: all of their intervals hold together with 95 %.
    pub most_rounds: usize,
    /// The rounds, in their order.
    pub rounds: Vec<RoundAnswer>,
    /// The estimate by all rounds.
    pub estimate: Option<PathBuf>,
    /// The intervals over time on the robot.
    pub figure: Option<PathBuf>,
}

impl Obstacle {
    /// What keeps a target out of reach by the estimate of all rounds: the law that it supports most, or else the joint whose torque is
    /// explained least.
    pub(super) fn of(target: &Target, pooled: &Estimate) -> Self {
        let strongest = |score: &dyn Fn(&Finding) -> Option<f64>| {
            let scored = pooled.findings.iter().filter_map(|finding| Some((score(finding)?, finding)));
            scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, finding)| finding)
        };
        let law = strongest(&|finding| match finding {
            Finding::EffectShown { p_adjusted, .. } => Some(-p_adjusted),
            _ => None,
        });
        let joint = || {
            strongest(&|finding| match finding {
                Finding::LackOfFit { beyond_noise_rms, torque_rms, .. } => Some(beyond_noise_rms / torque_rms),
                Finding::ResidualAboveNoise { ratio, .. } => Some(-1.0 / ratio),
                _ => None,
            })
        };
        let (effect, advice) = match law.or_else(joint) {
            Some(finding) => (finding.to_string(), finding.advice().to_owned()),
            None => (
                "what the robot file declares of drives and sensors, or what differs between rounds, is left"
                    .to_owned(),
                "calibrate the drives, or look for what changed between the rounds, such as temperature".to_owned(),
            ),
        };
        Self { target: target.clone(), effect, advice }
    }
}
