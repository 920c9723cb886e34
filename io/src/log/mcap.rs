//! MCAP files back to values: armid's own, and those of other tools that hold joint states.

use std::path::Path;

use armid::remedy::{Remedy, Setting, Task};
use armid_cdr::JointState;

use super::joint_log::Log;
use super::mcap_contents::{Contents, contents};
use super::topics::{StateReading, Topics};
use super::{foreign, recorded};
use crate::error::Error;
use crate::recording::STATES;

/// Reads the joint states in the bytes of a file. One that was cut off is read to its last chunk where its name ends in
/// `.part`.
///
/// # Errors
/// [`Error`] where the bytes are no MCAP, are damaged or cut off, or hold no joint states.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Log, Error> {
    log(path, contents(&path.display().to_string(), bytes)?, &StateReading::default())
}

/// Reads the bytes of a file if it is known what is looked for in joint states of other tools.
///
/// # Errors
/// As [`parse`].
pub(super) fn log(path: &Path, mut contents: Contents, reading: &StateReading<'_>) -> Result<Log, Error> {
    let name = path.display().to_string();
    let mut messages = Vec::new();
    if contents.metadata.is_none() {
        messages = reading.one_topic(&name, contents.topics())?;
        contents.states = messages.iter().map(|message| message.state.clone()).collect();
    }
    if !contents.whole && path.extension().is_none_or(|extension| extension != "part") {
        let last = contents.states.last().map_or(0.0, |state| state.stamp.seconds());
        let message = format!(
            "{name} is cut off: it ends after {} samples, at t = {last:.3} s, without the footer of an MCAP file",
            contents.states.len()
        );
        let help = "its whole chunks can be used as they are under a name that ends in .mcap.part";
        return Err(Error::new(message).help(help));
    }
    if contents.states.is_empty() {
        let message =
            format!("{name} holds no message of type {} on {STATES}, expected one per sample", JointState::NAME);
        let help = Remedy::task(Task::Run, "EXPERIMENT").option(Setting::Output, "R.mcap");
        return Err(Error::new(message).help(help.say(" or `ros2 bag record /joint_states` records them")));
    }
    let whole = contents.whole;
    let mut log = match &contents.metadata {
        Some(metadata) => recorded::log(&name, metadata, &contents)?,
        None => foreign::log(&name, &messages, reading)?,
    };
    log.complete = whole;
    Ok(log)
}

/// The joint states of one file of a bag, by topic.
pub(super) fn topics(name: &str, bytes: &[u8]) -> Result<Topics, Error> {
    Ok(contents(name, bytes)?.topics())
}
