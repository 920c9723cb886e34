//! What every implementation must satisfy, and the random robots to show it on.

pub mod arm_laws;
pub mod estimator_laws;
pub mod family_laws;
pub mod criterion_laws;
pub mod plant_laws;
pub mod plant_term_laws;
pub mod term_laws;
pub mod trajectory_laws;
mod law_error;

pub use crate::estimation::StiffLoop;
pub use armid_mechanics::chains;
pub use law_error::LawError;
