//! Kinds of files that hold joint states: how each begins, what it is called, and what reads it. Everything else is a table.

use std::path::Path;

use super::joint_log::Log;
use super::origin::FileHash;
use super::topics::{StateReading, Topics};
use super::{mcap, sqlite, states};
use crate::error::Error;

/// A kind of file that holds joint states.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogFormat {
    /// What such a file is called in a sentence.
    pub(super) name: &'static str,
    /// How it begins.
    pub(super) magic: &'static [u8],
    /// How its name ends; first that of a whole file.
    pub(super) suffixes: &'static [&'static str],
    /// Reads it as a log of its own.
    pub(super) log: fn(&Path, &[u8], &StateReading<'_>) -> Result<Log, Error>,
    /// Reads its joint states by topic, as one of several files.
    pub(super) topics: fn(&Path, &[u8]) -> Result<Topics, Error>,
}

impl LogFormat {
    /// Every kind.
    pub(super) const ALL: [Self; 2] = [
        Self {
            name: "an MCAP file",
            magic: ::mcap::MAGIC,
            suffixes: &[".mcap", ".mcap.part"],
            log: |path, bytes, reading| {
                let mut log = mcap::parse_as(path, bytes, reading)?;
                log.origin.files = vec![FileHash::of(path, bytes)];
                Ok(log)
            },
            topics: |path, bytes| mcap::topics(&path.display().to_string(), bytes),
        },
        Self {
            name: "a bag in SQLite",
            magic: sqlite::MAGIC,
            suffixes: &[".db3"],
            log: |path, bytes, reading| {
                let name = path.display().to_string();
                states::log(&name, vec![(FileHash::of(path, bytes), sqlite::topics(path)?)], reading)
            },
            topics: |path, _| sqlite::topics(path),
        },
    ];

    /// The kind that begins so.
    pub(super) fn of_bytes(bytes: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|format| bytes.starts_with(format.magic))
    }

    /// Whether a whole file of this kind is called so.
    pub(super) fn is_whole_file(&self, path: &Path) -> bool {
        name_of(path).ends_with(self.suffixes[0])
    }

    /// Whether a file of any kind is called so, a part of one too.
    pub(super) fn is_named(path: &Path) -> bool {
        let name = name_of(path);
        Self::ALL.iter().flat_map(|format| format.suffixes).any(|suffix| name.ends_with(suffix))
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
