//! Which reader a log is for.

use std::io::Read;
use std::path::Path;

use armid::input::size::RECORDING_BYTES;

use super::joint_log::Log;
use super::log_format::{self, LogFormat, Reader};
use super::topics::StateReading;
use super::{bag, foreign_csv, lerobot};
use crate::error::Error;
use crate::text::open;

impl Log {
    /// Reads a log: a folder as a data set of LeRobot or a bag, other files by their first bytes, or else as a table of text. An MCAP that
    /// was cut off is read to its last whole chunk where its name ends in `.part`.
    ///
    /// # Errors
    /// [`Error`] where the file cannot be read or is no log.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::read_as(path, &StateReading::default())
    }

    /// Reads a log if it is known what is looked for in joint states of other tools.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn read_as(path: &Path, reading: &StateReading<'_>) -> Result<Self, Error> {
        if lerobot::is_data_set(path) {
            return foreign_csv::of_tables(vec![lerobot::table(path)?], None, None);
        }
        if path.is_dir() {
            return bag::read(path, reading);
        }
        let mut source = open(path, &RECORDING_BYTES)?;
        if let Some(Reader::States(reader)) = LogFormat::of_source(path, &mut source)?.map(|format| format.reader) {
            return (reader.log)(path, &mut source, reading);
        }
        let mut bytes = Vec::new();
        source.read_to_end(&mut bytes).map_err(|error| Error::unreadable(path, &error))?;
        Self::of_table(path, bytes)
    }

    /// Reads a log from the bytes of a table: text, or another kind by how it begins. `path` is what errors call it.
    ///
    /// # Errors
    /// [`Error`] where it is none, or its headings do not say what its columns are.
    pub fn of_table(path: &Path, bytes: Vec<u8>) -> Result<Self, Error> {
        foreign_csv::of_tables(vec![log_format::table_of(path, bytes)?], None, None)
    }
}
