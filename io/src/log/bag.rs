//! Folders that `ros2 bag record` writes: `metadata.yaml` beside one or more files in MCAP or SQLite, each going on where the
//! one before ended.

use std::fs;
use std::path::{Path, PathBuf};

use armid::input::size::RECORDING_BYTES;

use super::joint_log::Log;
use super::log_format::{LogFormat, StatesReader};
use super::origin::FileHash;
use super::states::{self, RECORDED_BY};
use super::topics::StateReading;
use crate::error::Error;
use crate::text::open;

/// Reads the joint states of a bag.
///
/// # Errors
/// [`Error`] where the folder holds no such files, or those of two bags, or no joint states.
pub(super) fn read(folder: &Path, reading: &StateReading<'_>) -> Result<Log, Error> {
    let name = folder.display().to_string();
    let entries = fs::read_dir(folder).map_err(|error| Error::unreadable(folder, &error))?;
    let found: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    let mut of_format: Vec<((LogFormat, StatesReader), Vec<PathBuf>)> = Vec::new();
    for (format, reader) in LogFormat::of_states() {
        let files: Vec<PathBuf> = found.iter().filter(|path| format.is_whole_file(path)).cloned().collect();
        if !files.is_empty() {
            of_format.push(((format, reader), files));
        }
    }
    let endings = |of: &[LogFormat], between: &str| -> String {
        of.iter().map(|format| format.suffixes[0]).collect::<Vec<_>>().join(between)
    };
    let ((_, reader), mut files) = match of_format.len() {
        1 => of_format.remove(0),
        0 if found.iter().any(|path| path.extension().is_some_and(|ending| ending == "zstd")) => {
            let message = format!("{name} is a bag whose files are compressed, expected plain ones");
            return Err(Error::new(message).help("`zstd -d` on each .zstd file of the folder restores them"));
        }
        0 => {
            let message = format!(
                "{name} is a folder without {} files, expected a bag of `ros2 bag record`, or a log file",
                endings(&LogFormat::of_states().map(|(format, _)| format).collect::<Vec<_>>(), " or ")
            );
            return Err(Error::new(message).help(RECORDED_BY));
        }
        _ => {
            let formats: Vec<LogFormat> = of_format.into_iter().map(|((format, _), _)| format).collect();
            let message = format!("{name} holds {} files, expected those of one bag", endings(&formats, " and "));
            return Err(Error::new(message).help("name the files of one bag"));
        }
    };
    files.sort_by_key(|path| (number(path), path.clone()));
    let parts = files.iter().map(|path| {
        let mut source = open(path, &RECORDING_BYTES)?;
        Ok((FileHash::of(path, &mut source)?, (reader.topics)(path, &mut source)?))
    });
    states::log(&name, parts.collect::<Result<_, Error>>()?, reading)
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
