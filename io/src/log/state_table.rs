//! Joint states as a table.

use armid_cdr::{JointState, Time};

/// Positions and efforts in one order of joints, for any order in the messages.
#[derive(Default)]
pub(super) struct StateTable {
    joints: Vec<String>,
    /// When each message was sent, N.
    pub(super) stamps: Vec<Time>,
    /// Positions, N × n.
    pub(super) q: Vec<f64>,
    /// Efforts, N × n.
    pub(super) effort: Vec<f64>,
    /// What is wrong with the first message that lacks a joint.
    pub(super) fault: Option<String>,
}

impl StateTable {
    /// A table without rows.
    pub(super) fn new(joints: Vec<String>) -> Self {
        Self { joints, ..Self::default() }
    }

    /// Adds a row; behind a message with a fault only its stamp.
    pub(super) fn add(&mut self, state: &JointState) {
        self.stamps.push(state.stamp);
        if self.fault.is_some() {
            return;
        }
        let complete = state.position.len() == state.name.len() && state.effort.len() == state.name.len();
        for joint in &self.joints {
            let at = state.name.iter().position(|found| found == joint);
            let (Some(at), true) = (at, complete) else {
                self.fault = Some(format!(
                    "message {}: {} names, {} positions and {} efforts, expected one of each for joint \"{joint}\"",
                    self.stamps.len(),
                    state.name.len(),
                    state.position.len(),
                    state.effort.len()
                ));
                return;
            };
            self.q.push(state.position[at]);
            self.effort.push(state.effort[at]);
        }
    }
}
