//! How good is a design, how good is an estimator: the truth, the scores, and what many runs together say.
//!
//! ```text
//! StudyPlan → designs → (experiment → Samples → Observation → Estimate → Score) × conditions × runs → Findings
//! ```
//! This module comes last, so that nothing that identifies can name the [`Truth`].

mod atlas;
mod bound;
mod chain;
mod comparison;
mod condition;
mod design;
mod evidence;
mod examples;
mod failure;
mod family_score;
mod foretelling;
mod grid;
mod metric;
mod outcome;
pub mod paper;
mod plan;
mod random_truth;
mod referee;
mod result;
mod stage;
mod truth;
mod truth_comparison;
mod truth_files;
pub mod statistics;
mod units;
mod validity;

pub use atlas::{Atlas, AtlasBias, AtlasEntry};
pub use bound::{cramer_rao_std, torque_covariance};
pub use chain::Experiment;
pub use comparison::Comparison;
pub use condition::{Condition, ConditionResult, StatusCount};
pub use design::StudyDesign;
pub use evidence::{DesignRow, Evidence, Findings};
pub use examples::{Examples, LimitExample, PredictionExample, exact_states};
pub use failure::{Failure, FailureKind};
pub use family_score::{FamilyScore, ParameterScore};
pub use foretelling::Foretelling;
pub use grid::GridPlan;
pub use metric::Metric;
pub use outcome::{Outcome, ScoredEstimate};
pub use plan::{
    ExperimentSettings, FamilyPlan, HarmonicsPlan, IdentificationSettings, Making, PlanFault, StudyPlan,
    ValidationSettings,
};
pub use random_truth::{Centre, RandomTruths, TruthFault};
pub use referee::{Referee, Score};
pub use result::{JointLine, PaperResult, ParameterLine, StudyResult, StudyStory};
pub use stage::{Slot, Stage, StudyError};
pub use truth::Truth;
pub use truth_comparison::TruthComparison;
pub use truth_files::truth_text;
pub use units::ReferenceUnits;
pub use validity::feasible_ranges;
