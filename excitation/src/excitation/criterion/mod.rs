//! What makes a trajectory good: a number made from the information that it collects.
//!
//! ```text
//! M = (1/rows) Σ_k Y_b(k)ᵀ Σ⁻¹ Y_b(k) + M_prior        (b × b, per torque row)
//! ```
//! Every criterion is a value to be *minimised*. `radkhah2007` writes the d-optimality criterion as −log det M with M "the
//! covariance matrix or its Cramér–Rao lower bound", and says neither whether it is minimised nor maximised. Here M is
//! the information, and −ln det M is minimised, which makes the confidence volume of the estimate small.
//!
//! A criterion does not depend on robots: it turns M into a value and ∂value/∂M; the chain to the trajectory's
//! coefficients is the objective's. One that asks what the estimate is for gets a [`Prediction`], one that expects effects
//! their moments. Each is one file here, and all are listed once, in [`CriterionKind`], but [`PayloadOptimal`] and
//! [`LinearOptimal`], which are made for one base.

mod a_optimal;
mod condition;
mod condition_in_units;
mod condition_plus_d;
mod condition_plus_sigma;
mod condition_scaled;
mod d_optimal;
mod definition;
mod e_optimal;
mod i_optimal;
mod kind;
mod linear;
mod model_error;
mod payload;
mod prediction;
mod spectrum;

pub use a_optimal::AOptimal;
pub use condition::Condition;
pub use condition_in_units::ConditionInUnits;
pub use condition_plus_d::ConditionPlusD;
pub use condition_plus_sigma::ConditionPlusSigma;
pub use condition_scaled::ConditionScaled;
pub use d_optimal::DOptimal;
pub use definition::{Criterion, Score};
pub use e_optimal::EOptimal;
pub use i_optimal::IOptimal;
pub use kind::CriterionKind;
pub use linear::LinearOptimal;
pub use model_error::ModelError;
pub use payload::PayloadOptimal;
pub use prediction::{Carried, Prediction};
