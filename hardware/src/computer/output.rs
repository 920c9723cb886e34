//! What a controller sends.

use super::commander::Outcome;
use crate::message::JointState;

/// What a step leaves to be sent.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// A joint state.
    State(JointState),
    /// How a motion that was handed over has ended.
    Ended(Outcome, String),
    /// The process is to die at once.
    Die,
}
