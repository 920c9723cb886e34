//! Which parameters does a log give, and how surely?

mod advice;
mod answer;
mod findings;
mod friction_speed;
mod identify;
mod verdict;

pub use advice::advice;
pub use answer::{Identified, IdentifyAnswer};
pub use findings::grouped;
pub use friction_speed::hidden_speeds;
pub use identify::{IdentifySettings, identify};
pub use verdict::{Advised, FileError, JointShare, Verdict};
