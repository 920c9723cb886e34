//! Which motion, for how long, and which estimator: advice for an arm before it moves.
//!
//! A study on arms around the nominal one, with the effects that their drives may have, compares candidates. Each candidate is a
//! design with an estimator and its terms; its error is that of the arms drawn, over all levels of the effects alike.

mod advise;
mod answer;
mod earlier_log;
mod part;
mod settings;

pub use advise::advise;
pub use answer::{AdviceAnswer, Candidate, Longer, Undetermined};
pub use earlier_log::EarlierLog;
pub use settings::AdviceSettings;
