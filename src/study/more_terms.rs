//! Estimators of more terms than the columns of a study.
//!
//! ```text
//! wls+stribeck        the estimator wls, on the columns of the study and those of Stribeck friction
//! ```
//! Torque is predicted with all of its terms. Parameters are compared with others in the base of the study, which is part of its own.

use std::sync::Arc;

use super::measured_motion::MeasuredMotions;
use super::outcome::ScoredEstimate;
use super::own_methods::OwnMethods;
use super::plan::StudyPlan;
use super::plan_error::{StudyPlanError, number};
use super::scorer::Scorer;
use crate::base::BaseReduction;
use crate::estimation::{Estimate, Estimator};
use crate::model::{Columns, Robot};
use crate::regressor::JointTorqueRegressor;

/// An estimator that a plan names, and the columns that it estimates where they are not those of the study.
#[derive(Clone, Debug)]
pub(super) struct PlannedEstimator {
    pub(super) estimator: Arc<dyn Estimator>,
    /// As the plan has it.
    pub(super) name: String,
    pub(super) more: Option<Columns>,
}

/// Columns that estimators of a study have instead of its own.
#[derive(Clone, Debug)]
pub(super) struct MoreTerms {
    pub(super) columns: Columns,
    pub(super) regressor: JointTorqueRegressor,
    pub(super) base: BaseReduction,
    pub(super) scorer: Scorer,
    /// Where the base parameters of the study are among these, b.
    places: Vec<usize>,
}

impl MoreTerms {
    /// Columns whose base holds the parameters `usual` of a study.
    ///
    /// # Errors
    /// [`StudyPlanError`] where it does not hold all of them.
    pub(super) fn new(
        columns: Columns,
        (regressor, base, scorer): (JointTorqueRegressor, BaseReduction, Scorer),
        usual: &BaseReduction,
    ) -> Result<Self, StudyPlanError> {
        let names = base.names();
        let place = |name: &String| names.iter().position(|own| own == name);
        let places = usual.names().iter().map(place).collect::<Option<Vec<_>>>().ok_or_else(|| {
            number("identification.estimators", columns, "terms beside which the parameters of the study stay the same")
        })?;
        Ok(Self { columns, regressor, base, scorer, places })
    }

    /// An estimate of these columns with its scores: torque by all of them, parameters by those of the study.
    pub(super) fn scored(
        &self,
        name: &str,
        estimate: &Estimate,
        (robot, usual): (&Robot, &Scorer),
        (truth, measured): (usize, Option<&MeasuredMotions>),
    ) -> ScoredEstimate {
        let beta = estimate.beta();
        let of_usual = usual.score(&beta.select_rows(&self.places), truth, None);
        let mut score = self.scorer.score(&beta, truth, None);
        (score.reference_rmse, score.si_rmse) = (of_usual.reference_rmse, of_usual.si_rmse);
        let regressor = estimate.regressor(robot, self.columns).ok();
        let measure = |regressor| measured?.rmse_of(robot, &regressor, &self.base, &beta);
        score.measured_rmse_nm = regressor.and_then(measure);
        let all = ScoredEstimate::new(estimate, score);
        let usual = |values: &[f64]| self.places.iter().map(|&place| values[place]).collect();
        ScoredEstimate {
            estimator: name.to_owned(),
            beta: usual(&all.beta),
            std: usual(&all.std),
            half_width: usual(&all.half_width),
            ..all
        }
    }
}

impl StudyPlan {
    /// The estimators that are compared: of those from outside, and of [`EstimatorKind`](crate::estimation::EstimatorKind).
    ///
    /// # Errors
    /// [`StudyPlanError::Name`], [`StudyPlanError::Columns`], and terms in a study of sequences.
    pub(super) fn planned_estimators(&self, own: &OwnMethods) -> Result<Vec<PlannedEstimator>, StudyPlanError> {
        let planned = |found: &String| {
            let (name, terms) =
                found.split_once('+').map_or((found.as_str(), None), |(name, terms)| (name, Some(terms)));
            let estimator = own.estimator(name)?;
            let Some(terms) = terms else { return Ok(PlannedEstimator { estimator, name: found.clone(), more: None }) };
            if self.designs.iter().any(|family| family.after.is_some()) {
                return Err(number(
                    "identification.estimators",
                    found,
                    "no more terms, since a design comes after another",
                ));
            }
            let more = Columns::parse_estimable(&format!("{}+{terms}", self.identification.columns));
            let more = more.map_err(|fault| StudyPlanError::Columns { found: found.clone(), fault })?;
            Ok(PlannedEstimator { estimator, name: found.clone(), more: Some(more) })
        };
        self.identification.estimators.iter().map(planned).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::term::{MOTOR_STRIBECK, STRIBECK};

    fn plan(estimators: [&str; 2]) -> StudyPlan {
        let mut plan = StudyPlan::from_toml(include_str!("../../experiments/01-criteria/study.toml")).unwrap();
        plan.identification.estimators = estimators.map(str::to_owned).to_vec();
        plan
    }

    #[test]
    fn an_estimator_has_the_terms_behind_its_name() {
        let plan = plan(["wls", "irls-huber+stribeck"]);
        plan.check().unwrap();
        let planned = plan.planned_estimators(&OwnMethods::default()).unwrap();
        assert_eq!((planned[0].more, planned[1].estimator.name()), (None, "irls-huber"));
        assert_eq!(planned[1].more, Some(plan.columns().unwrap().with_term(STRIBECK).with_term(MOTOR_STRIBECK)));
    }

    #[test]
    fn what_is_no_term_or_no_estimator_and_terms_in_a_sequence_are_refused() {
        let fault = |plan: &StudyPlan| plan.check().unwrap_err().to_string();
        assert!(fault(&plan(["wls", "wls+rubber"])).contains("rubber"));
        assert!(fault(&plan(["wls", "guess+stribeck"])).contains("guess"));
        let mut sequence = plan(["wls", "wls+stribeck"]);
        let after = Some(sequence.designs[0].name.clone());
        sequence.designs[1].after = after;
        assert!(fault(&sequence).contains("wls+stribeck"));
    }
}
