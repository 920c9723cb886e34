//! Studies for tests: results that they write down, scores and comparisons alone, and a setup with few samples.

use super::comparison::Comparison;
use super::condition::{Condition, ConditionResult};
use super::evidence::Findings;
use super::family_score::FamilyScore;
use super::metric::Metric;
use super::plan::StudyPlan;
use super::result::StudyResult;
use super::scorer::Score;
use super::setup::StudySetup;
use super::truth::Truth;
use super::truth_files::truth_text;
use crate::experiment::Effects;
use crate::provenance::Provenance;
use crate::statistics::Interval;

/// The only estimator.
pub(super) const ESTIMATOR: &str = "wls";

/// A family by its torque error.
pub(super) fn score(family: &str, prediction: Option<f64>) -> FamilyScore {
    let mut values = vec![None; Metric::ALL.len()];
    values[0] = prediction;
    FamilyScore {
        family: family.to_owned(),
        estimator: ESTIMATOR.to_owned(),
        designs: 1,
        runs: usize::from(prediction.is_some()),
        intervals: vec![None; values.len()],
        values,
        coverage: 0.95,
        ..FamilyScore::default()
    }
}

/// An estimate that errs alike by every measure that it has.
pub(super) const fn erring(error: f64) -> Score {
    Score {
        prediction_rmse_nm: error,
        prediction_rmse_of_rating: error,
        joint_rmse_nm: Vec::new(),
        reference_rmse: error,
        si_rmse: error,
        measured_rmse_nm: None,
        slow_rmse_nm: error,
        point_to_point_rmse_nm: error,
        static_rmse_nm: Some(error),
    }
}

/// `[first, second]` by a difference inside its interval; `better` is the place of the better one.
pub(super) fn compared(
    metric: Metric,
    pair: [&str; 2],
    [low, difference, high]: [f64; 3],
    better: Option<usize>,
) -> Comparison {
    Comparison {
        metric,
        estimator: ESTIMATOR.to_owned(),
        first: pair[0].to_owned(),
        second: pair[1].to_owned(),
        difference,
        interval: Some(Interval { low, high }),
        better: better.map(|place| pair[place].to_owned()),
        ..Comparison::default()
    }
}

/// One scenario.
pub(super) fn scenario(name: &str, families: Vec<FamilyScore>, comparisons: Vec<Comparison>) -> ConditionResult {
    ConditionResult {
        condition: Condition { name: name.to_owned(), engine: "analytic".to_owned(), effects: Effects::none() },
        statuses: Vec::new(),
        findings: Findings { families, comparisons, ..Findings::default() },
    }
}

/// A study of these scenarios, by the plan of `experiments/01-criteria` with the estimator of the scores.
pub(super) fn study(conditions: Vec<ConditionResult>, compare_with: &[&str]) -> StudyResult {
    let mut plan = StudyPlan::from_toml(include_str!("../../experiments/01-criteria/study.toml")).unwrap();
    plan.identification.estimators = vec![ESTIMATOR.to_owned()];
    plan.compare_with = compare_with.iter().map(|&name| name.to_owned()).collect();
    StudyResult {
        plan,
        provenance: Provenance::new("arm", "", None),
        joints: Vec::new(),
        parameters: Vec::new(),
        designs: Vec::new(),
        bounds: Vec::new(),
        drawn_truths: Vec::new(),
        conditions,
        effect_sensitivity: None,
        radkhah2007: None,
    }
}

/// The study of `experiments/01-criteria` with one short validation motion.
pub(super) fn setup() -> StudySetup {
    let mut plan = StudyPlan::from_toml(include_str!("../../experiments/01-criteria/study.toml")).unwrap();
    (plan.validation.trajectories, plan.validation.samples) = (1, 10);
    let (robot, nominal) = (crate::chains::crs_a460(), crate::chains::crs_a460_nominal());
    let truth = Truth::from_toml(truth_text(&plan.robot).unwrap(), &robot).unwrap();
    StudySetup::new(plan, robot, nominal, &truth).unwrap()
}
