//! Which trajectory excites a robot best within its limits?

mod answer;
mod clearance;
mod perform;
mod problem;
mod search;
mod settings;

pub use answer::{DesignAnswer, Gain};
pub use clearance::{HeldClearance, PairLeftOut};
pub use perform::design;
pub use settings::{DesignGoal, DesignSettings, HeaviestLoad};
