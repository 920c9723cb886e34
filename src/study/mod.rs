//! How good is a design, how good is an estimator: the truth, the scores, and what many runs together say.
//!
//! ```text
//! StudyPlan → designs → (experiment → Samples → Observation → Estimate → Score) × runs → Findings
//! ```
//! This module comes last, so that nothing that identifies can name the [`Truth`].

mod outcome;
mod referee;
mod summary;
mod truth;
mod truth_files;
pub mod statistics;
mod units;
mod validity;

pub use outcome::{Outcome, ScoredEstimate};
pub use referee::{Referee, Score};
pub use summary::{Comparison, DesignRow, Evidence, FamilyScore, Findings, Foretelling, Metric, ParameterScore};
pub use truth::Truth;
pub use truth_files::truth_text;
pub use units::ReferenceUnits;
pub use validity::feasible_ranges;
