//! A log from the joint states of one or more files.

use super::foreign;
use super::joint_log::Log;
use super::origin::FileHash;
use super::topics::{StateReading, Topics};
use crate::error::Error;

/// What makes joint states.
pub(super) const RECORDED_BY: &str =
    "`ros2 bag record /joint_states` records one with positions and efforts of every joint";

/// The log of files, each with its joint states by topic, one going on where the one before ended.
///
/// # Errors
/// [`Error`] where they hold no joint states, or those of several topics.
pub(super) fn log(name: &str, files: Vec<(FileHash, Topics)>, reading: &StateReading<'_>) -> Result<Log, Error> {
    let (mut topics, mut hashes) = (Topics::new(), Vec::new());
    for (hash, more) in files {
        for (topic, messages) in more {
            match topics.iter_mut().find(|(known, _)| *known == topic) {
                Some((_, known)) => known.extend(messages),
                None => topics.push((topic, messages)),
            }
        }
        hashes.push(hash);
    }
    let messages = reading.one_topic(name, topics)?;
    if messages.is_empty() {
        return Err(Error::new(format!("{name} holds no joint states")).help(RECORDED_BY));
    }
    let mut log = foreign::log(name, &messages, reading)?;
    log.origin.files = hashes;
    Ok(log)
}
