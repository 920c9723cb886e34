//! How good is a design, how good is an estimator: the truth, the scores, and the statistics of many runs.
//!
//! ```text
//! StudyPlan → designs → (experiment → Samples → Observation → Estimate → Score) × conditions × runs → Findings
//! ```
//! This module comes after every module that identifies, so that none of them can name the [`Truth`].

mod effect_sensitivity;
mod bound;
mod experiment_sequence;
mod comparison;
mod condition;
mod design;
mod error;
mod estimator_comparison;
mod estimator_runs;
mod evidence;
mod examples;
mod run_error;
mod family_plan;
mod family_score;
mod criterion_correlation;
mod grid;
mod measured_motion;
mod metric;
mod outcome;
mod performed;
mod pilot;
mod plan;
mod plan_error;
mod point_to_point;
pub mod radkhah2007;
mod random_truth;
mod replication;
mod result;
mod run_id;
mod run_order;
mod run_table;
mod scorer;
mod plan_size;
mod setup;
mod shared_start;
mod status_count;
mod stopping_rule;
mod stored_work;
mod torque_rating;
mod truth;
mod truth_comparison;
mod truth_files;
mod validation;
#[cfg(test)]
mod validation_tests;
mod validity;
mod variance_reduction;
mod volume;

pub use crate::model::ReferenceUnits;
pub use bound::{cramer_rao_std, torque_covariance};
pub use comparison::Comparison;
pub use condition::{Condition, ConditionResult};
pub use criterion_correlation::CriterionCorrelation;
pub use design::StudyDesign;
pub use effect_sensitivity::{EffectSensitivity, ParameterBias, SensitivityEntry};
pub use error::StudyError;
pub use estimator_comparison::EstimatorComparison;
pub use evidence::{DesignRow, Evidence, Findings};
pub use examples::{Examples, LimitExample, PredictionExample, exact_states};
pub use family_plan::{DesignMethod, FamilyPlan, HarmonicsPlan};
pub use family_score::{FamilyScore, ParameterScore};
pub use grid::GridPlan;
pub use measured_motion::MeasuredMotions;
pub use metric::Metric;
pub use outcome::{Outcome, ScoredEstimate};
pub use performed::Performed;
pub use pilot::{ASSURANCE, StudySize, VarianceComponents};
pub use plan::{ExperimentSettings, IdentificationSettings, StudyPlan, ValidationSettings};
pub use plan_error::StudyPlanError;
pub use point_to_point::PointToPointMove;
pub use random_truth::{Centre, RandomTruths, TruthError};
pub use replication::Replication;
pub use result::{JointLine, ParameterLine, ReportInput, StudyResult};
pub use run_error::{RunError, RunErrorKind};
pub use run_id::RunId;
pub use run_order::RunOrder;
pub use run_table::{OutcomeTable, RunNumber, RunTable};
pub use scorer::{Score, Scorer};
pub use setup::StudySetup;
pub use shared_start::SharedStart;
pub use status_count::StatusCount;
pub use stopping_rule::{Look, RuleError, StoppingRule};
pub use stored_work::StoredWorkError;
pub use truth::Truth;
pub use truth_comparison::TruthComparison;
pub use truth_files::truth_text;
pub use validation::{MotionKind, ValidationError, ValidationMotions};
pub use validity::feasible_ranges;
pub use variance_reduction::VarianceReduction;
