//! Kinds of files that hold logs: how each begins, what it is called, and what reads it. Everything else is a table of text.

use std::io::Read;
use std::path::Path;

use armid::input::size::{RECORDING_BYTES, TEXT_BYTES};

use super::joint_log::Log;
use super::origin::FileHash;
use super::topics::{StateReading, Topics};
use super::{gzip, lerobot, mcap, npy, parquet_table, sqlite, states};
use crate::error::{Error, ErrorKind};
use crate::table::LogTable;
use crate::text::{Source, Text, read_bytes};

/// A kind of file that holds logs.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogFormat {
    /// What such a file is called in a sentence.
    pub(super) name: &'static str,
    /// How it begins.
    magic: &'static [u8],
    /// How its name ends; first that of a whole file.
    pub(super) suffixes: &'static [&'static str],
    /// What reads it.
    pub(super) reader: Reader,
}

/// What reads a kind of file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reader {
    /// It holds joint states.
    States(StatesReader),
    /// It holds columns.
    Table(fn(&Path, Vec<u8>) -> Result<LogTable, Error>),
}

/// What reads joint states.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatesReader {
    /// Reads a file as a log of its own.
    pub(super) log: fn(&Path, &mut dyn Source, &StateReading<'_>) -> Result<Log, Error>,
    /// Reads its joint states by topic, as one of several files.
    pub(super) topics: fn(&Path, &mut dyn Source) -> Result<Topics, Error>,
}

impl LogFormat {
    /// Every kind.
    const ALL: [Self; 6] = [
        Self {
            name: "an MCAP file",
            magic: ::mcap::MAGIC,
            suffixes: &[".mcap", ".mcap.part"],
            reader: Reader::States(StatesReader {
                log: |path, source, reading| {
                    let hash = FileHash::of(path, source)?;
                    let mut log = mcap::log(path, source, reading)?;
                    log.origin.files = vec![hash];
                    Ok(log)
                },
                topics: |path, source| mcap::topics(&path.display().to_string(), source),
            }),
        },
        Self {
            name: "a bag in SQLite",
            magic: sqlite::MAGIC,
            suffixes: &[".db3"],
            reader: Reader::States(StatesReader {
                log: |path, source, reading| {
                    let name = path.display().to_string();
                    states::log(&name, vec![(FileHash::of(path, source)?, sqlite::topics(path)?)], reading)
                },
                topics: |path, _| sqlite::topics(path),
            }),
        },
        Self { name: "a NumPy archive", magic: npy::ARCHIVE, suffixes: &[".npz"], reader: Reader::Table(npy::archive) },
        Self { name: "a NumPy array", magic: npy::ARRAY, suffixes: &[".npy"], reader: Reader::Table(npy::array) },
        Self {
            name: "a Parquet table",
            magic: parquet_table::MAGIC,
            suffixes: &[".parquet"],
            reader: Reader::Table(parquet_table::table),
        },
        Self {
            name: "a table in gzip",
            magic: gzip::MAGIC,
            suffixes: &[".csv.gz", ".txt.gz", ".tsv.gz"],
            reader: Reader::Table(|path, bytes| gzip::table(path, &bytes)),
        },
    ];

    /// The kind that begins so; `None` for text.
    ///
    /// # Errors
    /// [`Error`] where the name is that of a kind that begins in another way.
    pub(super) fn of(path: &Path, bytes: &[u8]) -> Result<Option<Self>, Error> {
        if let Some(format) = Self::ALL.into_iter().find(|format| bytes.starts_with(format.magic)) {
            return Ok(Some(format));
        }
        let Some(format) = Self::ALL.into_iter().find(|format| format.is_whole_file(path)) else { return Ok(None) };
        let magic: Vec<String> = format.magic.iter().map(|byte| format!("{byte:02X}")).collect();
        let message = format!("{} does not begin as {} does", path.display(), format.name);
        Err(Error::new(message).help(format!("expected the bytes {}", magic.join(" "))))
    }

    /// The kind of a file, which is left at its beginning.
    ///
    /// # Errors
    /// As [`Self::of`], and where it cannot be read.
    pub(super) fn of_source(path: &Path, source: &mut dyn Source) -> Result<Option<Self>, Error> {
        let longest = Self::ALL.iter().map(|format| format.magic.len()).max().unwrap_or(0);
        let mut beginning = Vec::new();
        let read = Read::take(&mut *source, longest as u64).read_to_end(&mut beginning).and_then(|_| source.rewind());
        read.map_err(|error| Error::unreadable(path, &error))?;
        Self::of(path, &beginning)
    }

    /// The kinds with joint states.
    pub(super) fn of_states() -> impl Iterator<Item = (Self, StatesReader)> {
        Self::ALL.into_iter().filter_map(|format| match format.reader {
            Reader::States(reader) => Some((format, reader)),
            Reader::Table(_) => None,
        })
    }

    /// Whether a whole file of this kind is called so.
    pub(super) fn is_whole_file(&self, path: &Path) -> bool {
        name_of(path).ends_with(self.suffixes[0])
    }

    /// Whether a file with joint states is called so, a part of one too.
    pub(super) fn is_of_states(path: &Path) -> bool {
        let name = name_of(path);
        Self::of_states().flat_map(|(format, _)| format.suffixes).any(|suffix| name.ends_with(suffix))
    }
}

/// What can be read, for whoever has something else.
pub(super) fn what_is_read() -> String {
    let list: Vec<String> =
        LogFormat::ALL.iter().map(|format| format!("{} ({})", format.name, format.suffixes.join(", "))).collect();
    format!(
        "a log is {}, a table of text (.csv, .txt, any other), a folder of `ros2 bag record`, or one of LeRobot ({})",
        list.join(", "),
        lerobot::INFO
    )
}

/// Reads a table: text, or what a binary file or a folder holds by columns.
///
/// # Errors
/// [`Error`] where it cannot be read, or is none.
pub(super) fn table(path: &Path) -> Result<LogTable, Error> {
    if lerobot::is_data_set(path) {
        return lerobot::table(path);
    }
    table_of(path, read_bytes(path, &RECORDING_BYTES)?)
}

/// The format of the bytes of a file.
///
/// # Errors
/// As [`table`].
pub(super) fn table_of(path: &Path, bytes: Vec<u8>) -> Result<LogTable, Error> {
    match LogFormat::of(path, &bytes)?.map(|format| (format.name, format.reader)) {
        Some((_, Reader::Table(read))) => read(path, bytes).map_err(|error| match error.kind() {
            ErrorKind::Unknown => error.help(what_is_read()),
            _ => error,
        }),
        Some((name, Reader::States(_))) => {
            Err(Error::mismatch(format!("{} is {name}, expected a table", path.display())).help(what_is_read()))
        }
        None => {
            TEXT_BYTES.check(&path.display().to_string(), bytes.len() as f64).map_err(Error::from)?;
            LogTable::of_text(Text::of_bytes(path, bytes).map_err(|error| error.help(what_is_read()))?)
        }
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{LogFormat, table_of, what_is_read};

    #[test]
    fn what_is_no_log_is_answered_with_what_can_be_read() {
        let all = what_is_read();
        assert!(LogFormat::ALL.iter().all(|format| format.suffixes.iter().all(|suffix| all.contains(suffix))), "{all}");
        for (name, bytes) in [("log.pt", &b"\x80\x02}q"[..]), ("log.mat", b"MATLAB 5.0\0\xFF")] {
            let fault = table_of(Path::new(name), bytes.to_vec()).unwrap_err();
            assert!(fault.message().starts_with(name) && fault.hint().as_deref() == Some(&all), "{fault}");
        }
        let fault = table_of(Path::new("q.npz"), b"t,q1\n".to_vec()).unwrap_err().to_string();
        assert_eq!(fault, "q.npz does not begin as a NumPy archive does");
    }
}
