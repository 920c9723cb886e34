//! Joint states as a table.

use armid_cdr::JointState;

use crate::error::Error;

/// Positions and efforts in the order of `joints`, for any order in the messages.
pub(super) fn columns(name: &str, joints: &[String], states: &[JointState]) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let mut q = Vec::with_capacity(states.len() * joints.len());
    let mut effort = Vec::with_capacity(states.len() * joints.len());
    for (k, state) in states.iter().enumerate() {
        let complete = state.position.len() == state.name.len() && state.effort.len() == state.name.len();
        for joint in joints {
            let at = state.name.iter().position(|found| found == joint);
            let (Some(at), true) = (at, complete) else {
                let message = format!(
                    "{name}: message {}: {} names, {} positions and {} efforts, expected one of each for joint \"{joint}\"",
                    k + 1,
                    state.name.len(),
                    state.position.len(),
                    state.effort.len()
                );
                return Err(Error::new(message));
            };
            q.push(state.position[at]);
            effort.push(state.effort[at]);
        }
    }
    Ok((q, effort))
}
