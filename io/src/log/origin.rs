//! Where a log came from and what was done to it, so that it can be done again.

use serde::{Deserialize, Serialize};

use super::channels::ChannelFault;
use super::stamps::Timing;

/// A file and what was in it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileHash {
    /// Its path, as it was given.
    pub path: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
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
    /// What else was done, a sentence each.
    pub remarks: Vec<String>,
    /// What the stamps said; `None` for a recording of armid's own.
    pub timing: Option<Timing>,
    /// Channels that stood still or ran into their end.
    pub channels: Vec<ChannelFault>,
}

impl Origin {
    /// Sentences about what was found in the log; none where all was well.
    #[must_use]
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
