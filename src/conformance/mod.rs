//! What every implementation must satisfy, and the random robots to show it on.

pub mod arm_laws;
pub mod chains;
pub mod estimator_laws;
pub mod family_laws;
pub mod criterion_laws;
pub mod plant_laws;
pub mod plant_term_laws;
pub mod term_laws;
pub mod trajectory_laws;
mod broken_law;

pub use broken_law::LawError;
