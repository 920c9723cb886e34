//! Whether stored work fits the study that it is said to belong to: numbers and lengths, before anything is indexed by them.

use super::design::StudyDesign;
use super::examples::Examples;
use super::metric::Metric;
use super::outcome::Outcome;
use super::plan_error::StudyPlanError;
use super::result::{ReportInput, StudyResult};
use super::setup::{PlannedDesign, StudySetup};
use crate::input::{FileNameError, check_file_name};

/// Stored work does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum StoredWorkError {
    /// A number that points at nothing.
    #[error("{what} is {found}, expected less than {count}")]
    Index { what: String, found: usize, count: usize },
    /// Another number, or a list of another length, than this study has.
    #[error("{what} is {found}, expected {expected}")]
    Number { what: String, found: usize, expected: usize },
    /// Estimates by another estimator than the plan names there.
    #[error("an estimator of {run} is {found}, expected {planned}")]
    Estimator { run: String, found: String, planned: String },
    /// The plan of stored results cannot be one.
    #[error(transparent)]
    Plan(#[from] StudyPlanError),
    /// A name is no part of a path.
    #[error(transparent)]
    Name(#[from] FileNameError),
}

type Checked = Result<(), StoredWorkError>;

fn below(what: impl Into<String>, found: usize, count: usize) -> Checked {
    if found < count { Ok(()) } else { Err(StoredWorkError::Index { what: what.into(), found, count }) }
}

fn equal(what: impl Into<String>, found: usize, expected: usize) -> Checked {
    if found == expected { Ok(()) } else { Err(StoredWorkError::Number { what: what.into(), found, expected }) }
}

impl StudySetup {
    /// Checks that a stored design is number `index` of this study, with a bound of so many parameters.
    ///
    /// # Errors
    /// [`StoredWorkError`] with what was found and what would fit.
    pub fn check_design(&self, index: usize, design: &StudyDesign, bound: usize) -> Result<(), StoredWorkError> {
        let designs = self.designs();
        below("the number of a design", index, designs.len())?;
        let PlannedDesign { family, start } = designs[index];
        equal(format!("the family of design {index}"), design.family, family)?;
        equal(format!("the start of design {index}"), design.start, start)?;
        equal(format!("the number of joints of design {index}"), design.trajectory.dof(), self.robot.dof())?;
        equal(format!("the number of bounds of design {index}"), bound, self.base.rank())
    }

    /// Checks that a stored outcome is one of this study.
    ///
    /// # Errors
    /// [`StoredWorkError`] with what was found and what would fit.
    pub fn check_outcome(&self, outcome: &Outcome) -> Result<(), StoredWorkError> {
        let designs = self.designs();
        below("the design of a run", outcome.design, designs.len())?;
        let run = format!("run {} of design {}", outcome.run, outcome.design);
        below(format!("the condition of {run}"), outcome.condition, self.plan.conditions().len())?;
        let runs = self.plan.runs_of(designs[outcome.design].family);
        below("the number of a run", usize::try_from(outcome.run).unwrap_or(usize::MAX), runs)?;
        equal(format!("the truth of {run}"), outcome.truth, self.plan.truth_of(outcome.run))?;
        let names = &self.plan.identification.estimators;
        let expected = if outcome.failure.is_some() { 0 } else { names.len() };
        equal(format!("the number of estimates of {run}"), outcome.estimates.len(), expected)?;
        for (estimate, name) in outcome.estimates.iter().zip(names) {
            if estimate.estimator != *name {
                let (found, planned) = (estimate.estimator.clone(), name.clone());
                return Err(StoredWorkError::Estimator { run, found, planned });
            }
            let Some(score) = &estimate.score else { continue };
            let what = |list: &str| format!("the number of {list} by {name} in {run}");
            for (list, found) in [
                ("estimates", estimate.beta.len()),
                ("standard deviations", estimate.std.len()),
                ("half widths", estimate.half_width.len()),
            ] {
                equal(what(list), found, self.base.rank())?;
            }
            equal(what("residuals"), estimate.residual_rms.len(), self.robot.dof())?;
            equal(what("joint errors"), score.joint_rmse_nm.len(), self.robot.dof())?;
        }
        Ok(())
    }
}

impl StudyResult {
    /// Checks that a stored result is complete: what reports index is there.
    ///
    /// # Errors
    /// [`StoredWorkError`] with what was found and what would fit.
    pub fn check(&self) -> Result<(), StoredWorkError> {
        let plan = &self.plan;
        plan.check_names_and_sizes()?;
        // They name figures, and may come from outside.
        plan.identification.estimators.iter().try_for_each(|name| check_file_name("an estimator", name))?;
        let (parameters, estimators) = (self.parameters.len(), plan.identification.estimators.len());
        let designs: usize = plan.designs.iter().map(|family| family.starts).sum();
        equal("the number of designs", self.designs.len(), designs)?;
        for design in &self.designs {
            below("the family of a design", design.family, plan.designs.len())?;
        }
        equal("the number of lists of bounds", self.bounds.len(), self.designs.len())?;
        for bounds in &self.bounds {
            equal("the number of bounds of a design", bounds.len(), parameters)?;
        }
        for truth in &self.drawn_truths {
            equal("the number of parameters of a truth", truth.len(), parameters)?;
        }
        equal("the number of conditions", self.conditions.len(), plan.conditions().len())?;
        for condition in &self.conditions {
            let findings = &condition.findings;
            for score in &findings.families {
                equal("the number of values of a family", score.values.len(), Metric::ALL.len())?;
                equal("the number of intervals of a family", score.intervals.len(), Metric::ALL.len())?;
                equal("the number of parameters of a family", score.parameters.len(), parameters)?;
            }
            equal("the number of estimators", findings.design_prediction.len(), estimators)?;
            for prediction in &findings.design_prediction {
                equal("the number of predictions of an estimator", prediction.len(), self.designs.len())?;
            }
        }
        if let Some(sensitivity) = &self.effect_sensitivity {
            for entry in &sensitivity.entries {
                // Where no run gave an estimate there is no bias.
                let parameters = if entry.runs > 0 { parameters } else { 0 };
                equal("the number of ratios of an effect", entry.kind_ratios.len(), sensitivity.kinds.len())?;
                equal("the number of biases of an effect", entry.parameters.len(), parameters)?;
                for &worst in &entry.worst {
                    below("a parameter of an effect", worst, parameters)?;
                }
            }
        }
        Ok(())
    }
}

impl ReportInput {
    /// Checks that stored results and examples are complete and of one study.
    ///
    /// # Errors
    /// [`StoredWorkError`] with what was found and what would fit.
    pub fn check(&self) -> Result<(), StoredWorkError> {
        self.result.check()?;
        self.examples.check(self.result.joints.len(), self.result.designs.len())
    }
}

impl Examples {
    fn check(&self, joints: usize, designs: usize) -> Checked {
        for example in &self.limits {
            check_file_name("the family of an example", &example.family)?;
            below("the design of an example", example.design, designs)?;
            let quantities = [&example.position, &example.velocity, &example.acceleration, &example.torque];
            for quantity in quantities {
                equal("the number of joints of an example", quantity.len(), joints)?;
                for values in quantity.iter().filter(|values| !values.is_empty()) {
                    equal("the number of samples of an example", values.len(), example.time_s.len())?;
                }
            }
        }
        if let Some(prediction) = &self.prediction {
            equal("the number of residuals of the prediction", prediction.rms.len(), joints)?;
            for series in [&prediction.measured, &prediction.predicted] {
                equal("the number of joints of the prediction", series.len(), joints)?;
                for values in series {
                    equal("the number of samples of the prediction", values.len(), prediction.time_s.len())?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_is_below_its_count() {
        assert!(below("a design", 2, 3).is_ok());
        assert!(below("a design", 3, 3).unwrap_err().to_string().contains('3'));
    }
}
