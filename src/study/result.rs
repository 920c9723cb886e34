//! The stored summary of a study: everything that its report is made from, beside the rows.

use super::condition::ConditionResult;
use super::design::StudyDesign;
use super::effect_sensitivity::EffectSensitivity;
use super::evidence::Findings;
use super::examples::Examples;
use super::plan::StudyPlan;
use super::radkhah2007::Reproduction;
use super::setup::StudySetup;
use crate::model::Joint;
use crate::provenance::Provenance;

/// The stored summary of a study. Equal plan, equal bytes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StudyResult {
    /// The plan as run.
    pub plan: StudyPlan,
    /// Version, robot and seed that produced it.
    pub provenance: Provenance,
    /// The robot's joints.
    pub joints: Vec<JointLine>,
    /// The base parameters.
    pub parameters: Vec<ParameterLine>,
    /// Every design.
    pub designs: Vec<StudyDesign>,
    /// Cramér–Rao standard deviations of each design, in the order of the parameters.
    #[serde(deserialize_with = "crate::plain::infinite::lists")]
    pub bounds: Vec<Vec<f64>>,
    /// True base parameters of each truth that was drawn, in the order of the parameters.
    #[serde(default)]
    pub drawn_truths: Vec<Vec<f64>>,
    /// The results under each condition, the first being the one that figures show.
    pub conditions: Vec<ConditionResult>,
    /// The sensitivity to each effect, where there are conditions with and without.
    #[serde(default, rename = "atlas", skip_serializing_if = "Option::is_none")]
    pub effect_sensitivity: Option<EffectSensitivity>,
    /// The claims of `radkhah2007` evaluated, and its Table II, where the plan asks for them.
    #[serde(rename = "paper")]
    pub radkhah2007: Option<Reproduction>,
}

impl StudyResult {
    /// The findings under the first condition.
    pub fn findings(&self) -> &Findings {
        &self.conditions[0].findings
    }

    /// The estimator that figures show: the last of the plan that gave an estimate under the first condition.
    pub fn shown_estimator(&self) -> &str {
        let (estimators, families) = (&self.plan.identification.estimators, &self.findings().families);
        let gave = |name: &&String| families.iter().any(|score| score.estimator == **name && score.runs > 0);
        estimators.iter().rev().find(gave).or(estimators.last()).map_or("", String::as_str)
    }
}

/// One joint, as tables and figures name it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct JointLine {
    /// Its name.
    pub name: String,
    /// Unit of its effort.
    pub effort_unit: String,
    /// Torque rating, in that unit; `None` where there is none.
    pub rating: Option<f64>,
}

/// One base parameter, as tables and figures name it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ParameterLine {
    /// Name of the parameter that stands for the combination.
    pub name: String,
    /// The combination, with its coefficients recognised.
    pub expression: String,
    /// Its unit on a revolute joint.
    pub unit: String,
    /// Its true value.
    pub truth: f64,
    /// The reference unit of its error.
    pub reference_unit: f64,
}

/// What the report of a study is made from: the result, and the single cases that its figures show.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportInput {
    /// The summary.
    pub result: StudyResult,
    /// The cases.
    pub examples: Examples,
}

impl StudySetup {
    /// Assembles the stored summary.
    pub fn result(
        &self,
        provenance: Provenance,
        designs: Vec<StudyDesign>,
        bounds: Vec<Vec<f64>>,
        conditions: Vec<ConditionResult>,
        effect_sensitivity: Option<EffectSensitivity>,
        radkhah2007: Option<Reproduction>,
    ) -> StudyResult {
        let (truth, units) = (&self.scorer.truths[0], &self.scorer.units);
        let parameter = |(i, (name, expression)): (usize, (String, String))| {
            let id = self.base.parameters[self.base.kept[i]];
            let unit = id.kind.unit(self.robot.joints()[id.index].kind).to_owned();
            ParameterLine { name, expression, unit, truth: truth[i], reference_unit: units[i] }
        };
        let expressions = self.base.names().into_iter().zip(self.base.expressions(&self.robot));
        let parameters = expressions.enumerate().map(parameter).collect();
        let joint = |joint: &Joint| JointLine {
            name: joint.name.clone(),
            effort_unit: joint.kind.effort_unit().to_owned(),
            rating: joint.limits.torque.is_finite().then_some(joint.limits.torque),
        };
        let joints = self.robot.joints().iter().map(joint).collect();
        StudyResult {
            plan: self.plan.clone(),
            provenance,
            joints,
            parameters,
            designs,
            bounds,
            drawn_truths: self.scorer.truths[1..].iter().map(|beta| beta.as_slice().to_vec()).collect(),
            conditions,
            effect_sensitivity,
            radkhah2007,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::study::small_results::{ESTIMATOR, scenario, score, study};

    #[test]
    fn the_last_estimator_that_gave_an_estimate_is_shown() {
        let shown = |prediction| {
            let mut result = study(vec![scenario("exact", vec![score("condition", prediction)], Vec::new())], &[]);
            result.plan.identification.estimators = vec!["ols".to_owned(), ESTIMATOR.to_owned(), "ekf".to_owned()];
            result.shown_estimator().to_owned()
        };
        // Of none that gave one, the last.
        assert_eq!((shown(Some(1.0)), shown(None)), (ESTIMATOR.to_owned(), "ekf".to_owned()));
    }
}
