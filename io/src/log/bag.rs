//! Folders that `ros2 bag record` writes: `metadata.yaml` beside one or more MCAP files, each going on where the one before
//! ended.

use std::fs;
use std::path::{Path, PathBuf};

use armid::provenance::sha256_of_bytes;

use super::joint_log::Log;
use super::origin::FileHash;
use super::{foreign, mcap};
use crate::error::Error;

/// Reads the joint states of a bag.
///
/// # Errors
/// [`Error`] where the folder holds no MCAP files, or no joint states.
pub(super) fn read(folder: &Path) -> Result<Log, Error> {
    let name = folder.display().to_string();
    let entries = fs::read_dir(folder).map_err(|error| Error::unreadable(folder, &error))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    let ends_with = |path: &PathBuf, ending: &str| path.extension().is_some_and(|found| found == ending);
    if files.iter().any(|path| ends_with(path, "db3")) {
        let message = format!("{name} is a bag in SQLite, expected one in MCAP");
        return Err(Error::new(message).help("`ros2 bag convert` writes the same bag as MCAP"));
    }
    files.retain(|path| ends_with(path, "mcap"));
    if files.is_empty() {
        let message =
            format!("{name} is a folder without .mcap files, expected a bag of `ros2 bag record`, or a log file");
        return Err(Error::new(message));
    }
    files.sort_by_key(|path| (number(path), path.clone()));
    let (mut states, mut hashes) = (Vec::new(), Vec::new());
    for path in &files {
        let bytes = fs::read(path).map_err(|error| Error::unreadable(path, &error))?;
        states.extend(mcap::bag_states(&path.display().to_string(), &bytes)?);
        hashes.push(FileHash { path: path.display().to_string(), sha256: sha256_of_bytes(&bytes) });
    }
    if states.is_empty() {
        return Err(Error::new(format!("{name} holds no joint states")));
    }
    let mut log = foreign::log(&name, &states)?;
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

    use super::{number, read};

    #[test]
    fn files_are_read_in_the_order_of_their_numbers() {
        assert!(number(Path::new("bag_9.mcap")) < number(Path::new("bag_10.mcap")));
        assert_eq!(number(Path::new("bag.mcap")), 0);
    }

    #[test]
    fn a_folder_that_is_no_bag_of_mcap_files_is_refused_with_what_helps() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read(folder.path()).unwrap_err().to_string().contains("without .mcap files"));
        std::fs::write(folder.path().join("bag_0.db3"), "").unwrap();
        assert!(read(folder.path()).unwrap_err().to_string().contains("is a bag in SQLite"));
    }
}
