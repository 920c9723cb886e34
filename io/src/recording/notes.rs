//! The notes of a recording, without its samples.

use std::collections::BTreeMap;
use std::path::Path;

use armid::input::size::RECORDING_BYTES;
use mcap::records::Record;

use super::{ENDING, METADATA};
use crate::error::Error;
use crate::log::Records;
use crate::text::open;

/// What armid noted in a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes {
    /// The metadata at its beginning; empty where another tool recorded it.
    pub beginning: BTreeMap<String, String>,
    /// The metadata at its end; empty where it was cut off.
    pub ending: BTreeMap<String, String>,
}

impl Notes {
    /// Whether the experiment was performed from beginning to end.
    pub fn is_complete(&self) -> bool {
        self.ending.get("ending").is_some_and(|word| word == "completed")
    }

    /// Reads the notes of a file.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read as MCAP.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let fault = |error: &dyn std::fmt::Display| Error::new(format!("{name} cannot be read as MCAP: {error}"));
        let source = open(path, &RECORDING_BYTES)?;
        let mut notes = Self::default();
        for record in Records::new(source, false).map_err(|error| fault(&error))? {
            match record {
                Ok(Record::Metadata(found)) if found.name == METADATA => notes.beginning = found.metadata,
                Ok(Record::Metadata(found)) if found.name == ENDING => notes.ending = found.metadata,
                Ok(_) => {}
                Err(mcap::McapError::UnexpectedEof | mcap::McapError::UnexpectedEoc) => break,
                Err(error) => return Err(fault(&error)),
            }
        }
        Ok(notes)
    }
}
