//! Which parameters does a log give, and how surely?

mod answer;
mod friction_speed;
mod identify;

pub use answer::{Identified, IdentifyAnswer, advice};
pub use friction_speed::hidden_speeds;
pub use identify::{IdentifySettings, identify};
