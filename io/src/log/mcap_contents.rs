//! What an MCAP file holds: joint states by topic, and what `armid run` noted beside them.

use std::collections::{BTreeMap, BTreeSet};

use ::mcap::McapError;
use ::mcap::records::Record;
use armid_cdr::{FloatArray, JointState};

use super::mcap_records::Records;
use super::state_table::StateTable;
use super::topics::{Message, Topics};
use crate::error::Error;
use crate::recording::{ENDING, LINKS, METADATA, STATES, VOLTAGE};
use crate::text::Source;

/// What a file holds.
#[derive(Default)]
pub(super) struct Contents {
    /// What was noted at the beginning; nothing where armid did not write the file.
    pub(super) metadata: Option<BTreeMap<String, String>>,
    /// What was noted at the end; empty where the file is cut off.
    pub(super) ending: BTreeMap<String, String>,
    /// The joint states of armid's own recording, unless they are asked for by topic.
    pub(super) table: StateTable,
    by_topic: bool,
    /// Those that something else recorded, or that are asked for by topic, in order.
    states: Vec<Message>,
    /// Time, ns, and motor voltages.
    pub(super) voltages: Vec<(u64, Vec<f64>)>,
    /// Time, ns, and positions behind the transmissions.
    pub(super) links: Vec<(u64, Vec<f64>)>,
    /// Joint states on other topics, by channel: the topic, and every message.
    others: BTreeMap<u16, (String, Vec<Message>)>,
    /// Whether its end is there.
    pub(super) whole: bool,
}

impl Contents {
    /// The joint states by topic.
    pub(super) fn topics(&mut self) -> Topics {
        let mut topics: Topics = vec![(STATES.to_owned(), std::mem::take(&mut self.states))];
        for (topic, messages) in std::mem::take(&mut self.others).into_values() {
            match topics.iter_mut().find(|(known, _)| *known == topic) {
                // Senders of one topic may have channels of their own.
                Some((_, known)) => {
                    known.extend(messages);
                    known.sort_by_key(|message| message.recorded_ns);
                }
                None => topics.push((topic, messages)),
            }
        }
        topics
    }

    /// Takes what `armid run` noted at the beginning; another tool may have put it behind the messages.
    fn take_metadata(&mut self, metadata: BTreeMap<String, String>) {
        let joints = metadata.get("joints").and_then(|joints| serde_json::from_str(joints).ok());
        self.table = StateTable::new(joints.unwrap_or_default());
        self.metadata = Some(metadata);
        if !self.by_topic {
            std::mem::take(&mut self.states).iter().for_each(|message| self.table.add(&message.state));
        }
    }

    /// Adds a message on the usual topic.
    fn add(&mut self, state: JointState, recorded_ns: i64) {
        if self.metadata.is_some() && !self.by_topic {
            self.table.add(&state);
            return;
        }
        let state = state.sharing_names(self.states.last().map(|last| &last.state));
        self.states.push(Message { recorded_ns, state });
    }
}

/// A time of a record, ns.
fn time_ns(time: u64) -> i64 {
    i64::try_from(time).unwrap_or(i64::MAX)
}

/// What a file holds, with all joint states by topic where that is asked for.
///
/// # Errors
/// [`Error`] where it is no MCAP, is damaged, or a message is not what its channel says.
pub(super) fn contents(name: &str, source: &mut dyn Source, by_topic: bool) -> Result<Contents, Error> {
    let fault = |error: &McapError| -> Error {
        let shown = Error::new(format!("{name} cannot be read as MCAP: {error}"));
        match error {
            McapError::UnsupportedCompression(_) => {
                shown.help("expected chunks without compression, or compressed by lz4 or zstd")
            }
            _ => shown,
        }
    };
    let mut contents = Contents { by_topic, ..Contents::default() };
    let (mut channels, mut voltage, mut links) = (BTreeSet::new(), None, None);
    let (mut schema, mut arrays) = (None, None);
    // A chunk's checksum is checked at its end: where that fails it says more than the message that was damaged.
    let mut undecodable: Option<Error> = None;
    for record in Records::new(source, true).map_err(|error| fault(&error))? {
        match record {
            Ok(Record::Schema { header, .. }) if header.name == JointState::NAME => schema = Some(header.id),
            Ok(Record::Schema { header, .. }) if header.name == FloatArray::NAME => arrays = Some(header.id),
            Ok(Record::Channel(found)) if found.topic == VOLTAGE && Some(found.schema_id) == arrays => {
                voltage = Some(found.id);
            }
            Ok(Record::Channel(found)) if found.topic == LINKS && Some(found.schema_id) == arrays => {
                links = Some(found.id);
            }
            Ok(Record::Channel(found)) if found.topic == STATES => {
                if Some(found.schema_id) != schema || found.message_encoding != "cdr" {
                    let message = format!("{name}: {STATES} is not {} in CDR, as recorded by ROS 2", JointState::NAME);
                    return Err(Error::new(message));
                }
                channels.insert(found.id);
            }
            Ok(Record::Channel(found)) if schema == Some(found.schema_id) && found.message_encoding == "cdr" => {
                // The summary at the end of a file names every channel again.
                contents.others.entry(found.id).or_insert((found.topic, Vec::new()));
            }
            Ok(Record::Message { header, data }) if contents.others.contains_key(&header.channel_id) => {
                let (topic, states) = contents.others.entry(header.channel_id).or_default();
                match JointState::decode(&data) {
                    Ok(state) => {
                        let state = state.sharing_names(states.last().map(|last| &last.state));
                        states.push(Message { recorded_ns: time_ns(header.log_time), state });
                    }
                    Err(error) => {
                        let message = format!("{name}: message {} on {topic}: {error}", states.len() + 1);
                        undecodable.get_or_insert_with(|| Error::new(message));
                    }
                }
            }
            Ok(Record::Message { header, data }) if channels.contains(&header.channel_id) => {
                let number = contents.table.stamps.len() + contents.states.len() + 1;
                match JointState::decode(&data) {
                    Ok(state) => contents.add(state, time_ns(header.log_time)),
                    Err(error) => {
                        let message = format!("{name}: message {number} on {STATES}: {error}");
                        undecodable.get_or_insert_with(|| Error::new(message));
                    }
                }
            }
            Ok(Record::Message { header, data }) if [voltage, links].contains(&Some(header.channel_id)) => {
                let (topic, arrays) = match Some(header.channel_id) == voltage {
                    true => (VOLTAGE, &mut contents.voltages),
                    false => (LINKS, &mut contents.links),
                };
                let number = arrays.len() + 1;
                match FloatArray::decode(&data) {
                    Ok(values) => arrays.push((header.log_time, values.data)),
                    Err(error) => {
                        let message = format!("{name}: message {number} on {topic}: {error}");
                        undecodable.get_or_insert_with(|| Error::new(message));
                    }
                }
            }
            Ok(Record::Metadata(found)) if found.name == METADATA => contents.take_metadata(found.metadata),
            Ok(Record::Metadata(found)) if found.name == ENDING => contents.ending = found.metadata,
            Ok(Record::Footer(_)) => contents.whole = true,
            Ok(_) => {}
            Err(McapError::UnexpectedEof | McapError::UnexpectedEoc) => break,
            Err(error) => return Err(fault(&error)),
        }
    }
    undecodable.map_or(Ok(contents), Err)
}
