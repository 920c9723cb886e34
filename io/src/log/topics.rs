//! Joint states by topic, where a recording has several.

use armid::cdr::JointState;

use crate::error::Error;
use crate::recording::STATES;

/// The joint states of the only topic that has any; none where no topic has.
///
/// # Errors
/// [`Error`] where several topics have some.
pub(super) fn one_topic(
    name: &str,
    topics: impl Iterator<Item = (String, Vec<JointState>)>,
) -> Result<Vec<JointState>, Error> {
    let mut found = topics.filter(|(_, states)| !states.is_empty());
    let Some((topic, states)) = found.next() else { return Ok(Vec::new()) };
    let others: Vec<String> = found.map(|(topic, _)| topic).collect();
    if others.is_empty() {
        return Ok(states);
    }
    let message =
        format!("{name} holds joint states on {topic}, {}, expected {STATES} or one topic", others.join(", "));
    Err(Error::new(message))
}
