//! Which reader a log is for.

use std::path::Path;

use armid::input::size::RECORDING_BYTES;

use super::joint_log::Log;
use super::log_format::LogFormat;
use super::topics::StateReading;
use super::{bag, csv};
use crate::error::Error;
use crate::text::{Text, read_bytes};

impl Log {
    /// Reads a log: a folder as a bag, MCAP and a bag's SQLite by their first bytes, CSV otherwise. An MCAP that was cut off is read to
    /// its last whole chunk where its name ends in `.part`.
    ///
    /// # Errors
    /// [`Error`] where the file cannot be read or is no log.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::read_as(path, &StateReading::default())
    }

    /// The same, where it is known what is looked for in joint states of other tools.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn read_as(path: &Path, reading: &StateReading<'_>) -> Result<Self, Error> {
        if path.is_dir() {
            return bag::read(path, reading);
        }
        let bytes = read_bytes(path, &RECORDING_BYTES)?;
        if let Some(format) = LogFormat::of_bytes(&bytes) {
            return (format.log)(path, &bytes, reading);
        }
        if let Some(format) = LogFormat::ALL.into_iter().find(|format| format.is_whole_file(path)) {
            let magic: Vec<String> = format.magic.iter().map(|byte| format!("{byte:02X}")).collect();
            let message = format!("{} does not begin as {} does", path.display(), format.name);
            return Err(Error::new(message).help(format!("expected the bytes {}", magic.join(" "))));
        }
        csv::parse(Text::of_bytes(path, bytes)?)
    }
}
