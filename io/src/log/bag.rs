//! Folders that `ros2 bag record` writes: `metadata.yaml` beside one or more files in MCAP or SQLite, each going on where the
//! one before ended.

use std::fs;
use std::path::{Path, PathBuf};

use armid::input::size::RECORDING_BYTES;
use armid::provenance::sha256_of_bytes;

use super::joint_log::Log;
use super::origin::FileHash;
use super::topics::{StateReading, Topics};
use super::{foreign, mcap, sqlite};
use crate::error::Error;
use crate::text::read_bytes;

/// What makes a bag.
const RECORDED_BY: &str = "`ros2 bag record /joint_states` records one with positions and efforts of every joint";

/// Reads the joint states of a bag.
///
/// # Errors
/// [`Error`] where the folder holds no such files, or those of two bags, or no joint states.
pub(super) fn read(folder: &Path, reading: &StateReading<'_>) -> Result<Log, Error> {
    let name = folder.display().to_string();
    let entries = fs::read_dir(folder).map_err(|error| Error::unreadable(folder, &error))?;
    let files: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    let ending = |ending: &str| -> Vec<PathBuf> {
        files.iter().filter(|path| path.extension().is_some_and(|found| found == ending)).cloned().collect()
    };
    let (in_mcap, in_sqlite) = (ending("mcap"), ending("db3"));
    let mut files = match (in_mcap.is_empty(), in_sqlite.is_empty()) {
        (false, true) => in_mcap,
        (true, false) => in_sqlite,
        (false, false) => {
            let message = format!("{name} holds .mcap and .db3 files, expected those of one bag");
            return Err(Error::new(message).help("name the files of one bag"));
        }
        (true, true) if !ending("zstd").is_empty() => {
            let message = format!("{name} is a bag whose files are compressed, expected plain ones");
            return Err(Error::new(message).help("`zstd -d` on each .zstd file of the folder restores them"));
        }
        (true, true) => {
            let message = format!(
                "{name} is a folder without .mcap or .db3 files, expected a bag of `ros2 bag record`, or a log file"
            );
            return Err(Error::new(message).help(RECORDED_BY));
        }
    };
    files.sort_by_key(|path| (number(path), path.clone()));
    of_files(&name, &files, reading)
}

/// Reads the joint states of one file of a bag in SQLite.
///
/// # Errors
/// As [`read`].
pub(super) fn read_sqlite(file: &Path, reading: &StateReading<'_>) -> Result<Log, Error> {
    of_files(&file.display().to_string(), &[file.to_path_buf()], reading)
}

fn of_files(name: &str, files: &[PathBuf], reading: &StateReading<'_>) -> Result<Log, Error> {
    let (mut topics, mut hashes) = (Topics::new(), Vec::new());
    for path in files {
        let bytes = read_bytes(path, &RECORDING_BYTES)?;
        let is_sqlite = path.extension().is_some_and(|ending| ending == "db3");
        let more = if is_sqlite { sqlite::topics(path) } else { mcap::topics(&path.display().to_string(), &bytes) };
        for (topic, messages) in more? {
            match topics.iter_mut().find(|(known, _)| *known == topic) {
                Some((_, known)) => known.extend(messages),
                None => topics.push((topic, messages)),
            }
        }
        hashes.push(FileHash { path: path.display().to_string(), sha256: sha256_of_bytes(&bytes) });
    }
    let messages = reading.one_topic(name, topics)?;
    if messages.is_empty() {
        return Err(Error::new(format!("{name} holds no joint states")).help(RECORDED_BY));
    }
    let mut log = foreign::log(name, &messages, reading)?;
    log.origin.files = hashes;
    Ok(log)
}

/// The number at the end of a file's name: `bag_10` comes behind `bag_9`.
fn number(path: &Path) -> u64 {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let digits: String = stem.chars().rev().take_while(char::is_ascii_digit).collect();
    digits.chars().rev().collect::<String>().parse().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::topics::StateReading;
    use super::{number, read};

    #[test]
    fn files_are_read_in_the_order_of_their_numbers() {
        assert!(number(Path::new("bag_9.mcap")) < number(Path::new("bag_10.mcap")));
        assert_eq!(number(Path::new("bag.mcap")), 0);
    }

    #[test]
    fn a_folder_that_is_no_bag_is_refused_with_what_helps() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |wanted: &str| {
            let fault = read(folder.path(), &StateReading::default()).unwrap_err().to_string();
            assert!(fault.contains(wanted), "{fault}");
        };
        refused("without .mcap or .db3 files");
        std::fs::write(folder.path().join("bag_0.db3.zstd"), "").unwrap();
        refused("compressed");
        std::fs::write(folder.path().join("bag_0.db3"), "").unwrap();
        refused("cannot be read as a bag in SQLite");
        std::fs::write(folder.path().join("bag_0.mcap"), "").unwrap();
        refused("holds .mcap and .db3 files");
    }
}
