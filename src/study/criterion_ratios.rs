//! The torque error of two criteria relative to a third on one robot, effect by effect: what a figure over several studies shows.

use super::metric::Metric;
use super::result::StudyResult;
use super::robots_summary::RobotDifference;
use crate::experiment::Level;

/// The criteria by the names of their designs, and the one that they are compared with.
const CRITERIA: [&str; 2] = ["condition", "i-optimal"];
pub(super) const REFERENCE: &str = "d-optimal";

/// Torque errors on random motions relative to the reference, on one robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CriterionRatios {
    /// Name of the robot.
    pub robot: String,
    /// The criterion that the others are compared with.
    pub reference: String,
    /// Number of its designs.
    pub designs: usize,
    /// The ratios, in the order of the study.
    pub ratios: Vec<EffectRatio>,
}

/// One criterion under one effect.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectRatio {
    /// Name of the only unmodelled effect; `None` if the model is exact.
    pub effect: Option<String>,
    /// The criterion.
    pub criterion: String,
    /// Its error over that of the reference.
    pub error: RobotDifference,
}

impl CriterionRatios {
    /// The ratios of a study with an exact model and with each single effect at its realistic level, last estimator, first
    /// engine. Other levels and combinations are left out: they repeat these effects.
    pub fn from_result(result: &StudyResult) -> Self {
        let plan = &result.plan;
        let (estimator, engine) = (plan.identification.estimators.last(), plan.engines.first());
        let mut ratios = Vec::new();
        for part in result.conditions.iter().filter(|part| Some(&part.condition.engine) == engine) {
            let effects = plan.effects.overridden_by(&part.condition.effects);
            let effect = match effects.iter().collect::<Vec<_>>()[..] {
                [] => None,
                [(kind, size)] if kind.level(size) == Some(Level::Realistic) => Some(kind.name().to_owned()),
                _ => continue,
            };
            for criterion in CRITERIA {
                let all = part.findings.comparisons.iter();
                let of_estimator = all.filter(|c| c.metric == Metric::Prediction && Some(&c.estimator) == estimator);
                let found = of_estimator.filter_map(|c| c.over(REFERENCE)).find(|c| c.first == criterion);
                ratios.extend(found.map(|c| EffectRatio {
                    effect: effect.clone(),
                    criterion: criterion.to_owned(),
                    error: RobotDifference::of(&c),
                }));
            }
        }
        Self {
            robot: result.provenance.robot.clone(),
            reference: REFERENCE.to_owned(),
            designs: designs_of_reference(result),
            ratios,
        }
    }
}

/// Number of designs of the reference.
pub(super) fn designs_of_reference(result: &StudyResult) -> usize {
    let is_reference = |family: usize| result.plan.designs.get(family).is_some_and(|design| design.name == REFERENCE);
    result.designs.iter().filter(|design| is_reference(design.family)).count()
}
