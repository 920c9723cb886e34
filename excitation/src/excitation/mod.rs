//! How should the arm move so that its parameters show best, without breaking a limit?
//!
//! `radkhah2007` sections II.C, II.D and III: a design problem ([`DesignProblem`]) says which robot, limits, criterion and
//! budget; the search looks, among the trajectories of one family, for the least value of a criterion of the information
//! `M = W_bᵀ Σ⁻¹ W_b` of the base columns; a certificate states what the result is worth and that it is safe.

mod basis;
mod certificate;
mod certified_file;
pub mod clearance;
mod column_lines;
pub mod criterion;
mod descent;
mod design;
mod design_search;
pub mod effort;
mod error;
mod evaluation;
mod expected;
mod feasibility;
mod information;
mod limit_kind;
mod limit_rows;
mod limit_survey;
mod limits;
mod margins;
mod objective;
mod path_rows;
mod problem;
mod rms_speed;
mod sampled;
mod start;
mod termination;
mod verification;
mod watched;

pub use basis::MotionBasis;
pub use certificate::{Certificate, WeakParameter};
pub use criterion::{Criterion, CriterionKind};
pub use design::{Design, best_of, nearest_of};
pub use design_search::{design, design_from, random_design};
pub use error::ExcitationError;
pub use evaluation::EvaluationMotions;
pub use expected::{EffectLaw, EffectTorques, ExpectedEffect, ExpectedEffects, WarmGear, WarmGears};
pub use information::Information;
pub use limit_kind::LimitKind;
pub use limit_rows::LimitRows;
pub use limit_survey::{WorstCases, WorstLimitUse};
pub use limits::WorstUse;
pub use margins::Margins;
pub use objective::InformationObjective;
pub use problem::{
    DEFAULT_EVALUATIONS, DesignBudget, DesignLimits, DesignObjective, DesignProblem, DesignSpace, LimitSettings,
};
pub use rms_speed::rms_speed;
pub use sampled::SampledBasis;
pub use start::{START_VELOCITIES, radkhah2007_start};
pub use termination::{HistoryPoint, Termination};
pub use verification::{VerificationError, verify_certificate, verify_performance};
pub use watched::WatchedProblem;
