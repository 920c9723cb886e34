//! Joint states by topic, where a recording has several.

use armid::model::Robot;
use armid::remedy::{Remedy, Setting};
use armid_cdr::JointState;

use super::mapping::Mapping;
use crate::error::Error;
use crate::recording::STATES;

/// A joint state, and when it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Message {
    /// By the clock of the recorder, ns.
    pub(super) recorded_ns: i64,
    /// What was sent.
    pub(super) state: JointState,
}

/// Messages of each topic that has joint states.
pub(super) type Topics = Vec<(String, Vec<Message>)>;

/// What is looked for in joint states.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StateReading<'a> {
    /// Which topic, and which joints in which units, where that is stated.
    pub(super) mapping: Option<&'a Mapping>,
    /// The arm whose joints are looked for; without one, the joints are those of the first message.
    pub(super) robot: Option<&'a Robot>,
}

impl StateReading<'_> {
    /// The messages on the topic that is stated, else on the usual one, else on the only one that has any; none where no topic
    /// has.
    ///
    /// # Errors
    /// [`Error`] where several topics have some, or the one that is stated has none.
    pub(super) fn one_topic(&self, name: &str, topics: Topics) -> Result<Vec<Message>, Error> {
        let stated = self.mapping.and_then(|mapping| mapping.topic.as_deref());
        let mut topics: Topics = topics.into_iter().filter(|(_, messages)| !messages.is_empty()).collect();
        let wanted = topics.iter().position(|(topic, _)| topic == stated.unwrap_or(STATES));
        if let Some(at) = wanted {
            return Ok(topics.swap_remove(at).1);
        }
        let names: Vec<&str> = topics.iter().map(|(topic, _)| topic.as_str()).collect();
        if let Some(stated) = stated {
            let found = if names.is_empty() { "none on any topic".to_owned() } else { names.join(", ") };
            return Err(Error::mismatch(format!("{name} holds no joint states on {stated}, found {found}")));
        }
        if let [first, _, ..] = names.as_slice() {
            let message = format!("{name} holds joint states on {}, expected {STATES} or one topic", names.join(", "));
            return Err(
                Error::new(message).help(Remedy::set(Setting::Map, format!("topic={first}")).say(" chooses one"))
            );
        }
        Ok(topics.pop().map(|(_, messages)| messages).unwrap_or_default())
    }
}
