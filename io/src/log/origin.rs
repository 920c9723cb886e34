//! Where a log came from and what was done to it, so that it can be done again.

use std::io;
use std::path::Path;

use armid::diagnosis::Mistake;
use armid::model::Robot;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::channels::ChannelFault;
use super::effort_scale::EffortScale;
use super::mapping::{ColumnMap, Mapping, Quantity, corrected};
use super::stamps::Timing;
use crate::error::Error;
use crate::text::Source;

/// A file and what was in it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileHash {
    /// Its path, as it was given.
    pub path: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

impl FileHash {
    /// That of a file, which is left at its beginning.
    ///
    /// # Errors
    /// [`Error`] where it cannot be read.
    pub(super) fn of(path: &Path, source: &mut dyn Source) -> Result<Self, Error> {
        let mut hash = Sha256::new();
        let read = source.rewind().and_then(|()| io::copy(source, &mut hash)).and_then(|_| source.rewind());
        read.map_err(|error| Error::unreadable(path, &error))?;
        let sha256 = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { path: path.display().to_string(), sha256 })
    }
}

/// Where a log came from.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Origin {
    /// Its files.
    pub files: Vec<FileHash>,
    /// What each quantity was read from, a sentence each.
    pub columns: Vec<String>,
    /// Columns that nothing was read from.
    pub skipped_columns: Vec<String>,
    /// The mapping, where there was one.
    pub mapping: Option<String>,
    /// The mapping that the log was read by, be it stated or found in the headings.
    #[serde(skip)]
    pub(super) read_as: Option<ReadAs>,
    /// What else was done, a sentence each.
    pub remarks: Vec<String>,
    /// What the stamps said; `None` for a recording of armid's own.
    pub timing: Option<Timing>,
    /// Channels that stood still or ran into their end.
    pub channels: Vec<ChannelFault>,
}

/// How a log was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ReadAs {
    /// The mapping.
    pub(super) mapping: Mapping,
    /// The columns of each quantity, joint by joint, as a mapping names them.
    pub(super) columns: Vec<(Quantity, Vec<String>)>,
}

impl Origin {
    /// What `--map` is to say so that a mistake in a log of this robot is corrected: several where the data do not show which,
    /// none where that is not known.
    pub fn corrected(&self, mistake: &Mistake, robot: &Robot) -> Vec<String> {
        let Some(read_as) = &self.read_as else { return Vec::new() };
        let all = corrected(&read_as.mapping, &read_as.columns, mistake, robot);
        all.iter().map(Mapping::text).collect()
    }

    /// What `--map` is to say where the efforts are currents of motors whose constants are not known.
    pub(super) fn with_constants(&self) -> Option<String> {
        let mut mapping = self.read_as.as_ref()?.mapping.clone();
        let effort =
            mapping.columns.iter_mut().find(|map| matches!(map.quantity, Quantity::Current | Quantity::Torque))?;
        effort.unit = effort.unit.filter(|unit| Quantity::Current.units().contains(unit));
        (effort.quantity, effort.constant, effort.gear) = (Quantity::Current, Some(vec![0.05]), Some(vec![100.0]));
        Some(mapping.text())
    }

    /// Whether a mapping has made torques of currents.
    pub(super) fn has_constants(&self) -> bool {
        let maps = self.read_as.iter().flat_map(|read_as| &read_as.mapping.columns);
        maps.into_iter().any(|map| map.constant.is_some())
    }

    /// By what a mapping has made torques of currents or commands, for each of `n` joints; none where it has made none.
    pub(super) fn scale(&self, n: usize) -> Option<(EffortScale, Vec<f64>)> {
        let maps = self.read_as.iter().flat_map(|read_as| &read_as.mapping.columns);
        let (scale, stated) = maps.into_iter().find_map(|map| {
            let constant = map.constant.as_ref().map(|stated| (EffortScale::MappedConstant, stated));
            constant.or_else(|| map.kp.as_ref().map(|stated| (EffortScale::ServoStiffness, stated)))
        })?;
        let each = if let [one] = stated[..] { vec![one; n] } else { stated.clone() };
        Some((scale, each))
    }

    /// The mapping of commands, where the torques are those of servos.
    pub(super) fn commands(&self) -> Option<&ColumnMap> {
        self.read_as.as_ref()?.mapping.columns(Quantity::Command)
    }

    /// Sentences about what was found in the log; none where all was well.
    pub fn sentences(&self) -> Vec<String> {
        let mut found = self.remarks.clone();
        if !self.skipped_columns.is_empty() {
            found.push(format!("columns that were not used: {}", self.skipped_columns.join(", ")));
        }
        found.extend(self.timing.iter().flat_map(Timing::sentences));
        found.extend(self.channels.iter().map(ChannelFault::sentence));
        found
    }
}
