//! MCAP files back to values: armid's own, and those of other tools that hold joint states.

use std::io::Cursor;
use std::path::Path;

use armid::remedy::{Remedy, Setting, Task};
use armid_cdr::JointState;

use super::joint_log::Log;
use super::mcap_contents::contents;
use super::topics::{StateReading, Topics};
use super::{foreign, recorded};
use crate::error::Error;
use crate::recording::STATES;
use crate::text::Source;

/// Reads the joint states in the bytes of a file. One that was cut off is read to its last chunk where its name ends in
/// `.part`.
///
/// # Errors
/// [`Error`] where the bytes are no MCAP, are damaged or cut off, or hold no joint states.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Log, Error> {
    log(path, &mut Cursor::new(bytes), &StateReading::default())
}

/// Reads a file if it is known what is looked for in joint states of other tools.
///
/// # Errors
/// As [`parse`].
pub(super) fn log(path: &Path, source: &mut dyn Source, reading: &StateReading<'_>) -> Result<Log, Error> {
    let name = path.display().to_string();
    let mut contents = contents(&name, source, false)?;
    let mut messages = Vec::new();
    if contents.metadata.is_none() {
        messages = reading.one_topic(&name, contents.topics())?;
    }
    let last = contents.table.stamps.last().or_else(|| messages.last().map(|message| &message.state.stamp));
    let count = contents.table.stamps.len().max(messages.len());
    if !contents.whole && path.extension().is_none_or(|extension| extension != "part") {
        let message = format!(
            "{name} is cut off: it ends after {count} samples, at t = {:.3} s, without the footer of an MCAP file",
            last.map_or(0.0, |stamp| stamp.seconds())
        );
        let help = "its whole chunks can be used as they are under a name that ends in .mcap.part";
        return Err(Error::new(message).help(help));
    }
    if count == 0 {
        let message =
            format!("{name} holds no message of type {} on {STATES}, expected one per sample", JointState::NAME);
        let help = Remedy::task(Task::Run, "EXPERIMENT").option(Setting::Output, "R.mcap");
        return Err(Error::new(message).help(help.say(" or `ros2 bag record /joint_states` records them")));
    }
    let whole = contents.whole;
    let mut log = if contents.metadata.is_some() {
        recorded::log(&name, contents)?
    } else {
        foreign::log(&name, &messages, reading)?
    };
    log.complete = whole;
    Ok(log)
}

/// The joint states of one file of a bag, by topic.
pub(super) fn topics(name: &str, source: &mut dyn Source) -> Result<Topics, Error> {
    Ok(contents(name, source, true)?.topics())
}
