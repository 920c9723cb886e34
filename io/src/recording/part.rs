//! `R.mcap.part`: what a recording is called until it is whole, and whose it is.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting};

use crate::error::Error;
use crate::output::regular_file;

/// `R.mcap.part` for `R.mcap`: what a file is called that is not whole.
pub fn part_path(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// A new recording may be made at this place: what an earlier one left there is never written over.
///
/// # Errors
/// [`Error`] where its part, or something that is no file, is there.
pub fn check_free(path: &Path) -> Result<(), Error> {
    let place = regular_file(path)?;
    let part = part_path(&place);
    match part.symlink_metadata() {
        Ok(_) => Err(taken(&part)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(Error::unwritable(&part, &error)),
    }
}

/// No process writes this part at the moment.
///
/// # Errors
/// [`Error`] where one does.
pub fn check_at_rest(part: &Path) -> Result<(), Error> {
    let file = File::open(part).map_err(|error| Error::unreadable(part, &error))?;
    match file.try_lock_shared() {
        Err(TryLockError::WouldBlock) => Err(being_written(part)),
        // A file system without locks is no reason not to work.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// Makes a part that is not there, and keeps others from it.
pub(super) fn create(part: &Path) -> Result<File, Error> {
    match OpenOptions::new().create_new(true).write(true).open(part) {
        Ok(file) => locked(file, part),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(taken(part)),
        Err(error) => Err(Error::unwritable(part, &error)),
    }
}

/// Begins the draft of a part that goes on; what an attempt that was cut short left of one is in the part, too.
pub(super) fn create_draft(draft: &Path) -> Result<File, Error> {
    let fault = |error: io::Error| Error::unwritable(draft, &error);
    let file = OpenOptions::new().create(true).write(true).truncate(false).open(draft).map_err(fault)?;
    let file = locked(file, draft)?;
    file.set_len(0).map_err(fault)?;
    Ok(file)
}

fn locked(file: File, path: &Path) -> Result<File, Error> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(being_written(path)),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

fn taken(part: &Path) -> Error {
    let message = format!(
        "{} is there: an experiment was cut short or is under way, expected no part of a recording",
        part.display()
    );
    Error::new(message).help(
        Remedy::default()
            .setting(Setting::Resume)
            .say(" continues it (MCAP); ")
            .setting(Setting::Output)
            .say(" chooses another file; move or delete it to begin anew"),
    )
}

fn being_written(part: &Path) -> Error {
    Error::new(format!("{} is being written by another experiment", part.display()))
        .help(Remedy::from("wait for it, or choose another place with ").setting(Setting::Output))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_earlier_experiment_left_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("R.mcap");
        assert!(check_free(&path).is_ok());
        let file = create(&part_path(&path)).unwrap();
        assert!(check_at_rest(&part_path(&path)).unwrap_err().to_string().contains("is being written by another"));
        drop(file);
        check_at_rest(&part_path(&path)).unwrap();
        for refused in [check_free(&path).unwrap_err(), create(&part_path(&path)).unwrap_err()] {
            assert!(refused.to_string().contains("R.mcap.part is there"), "{refused}");
            assert!(refused.hint().unwrap().contains("resume"));
        }
        let draft = folder.path().join("R.mcap.part.new");
        let first = create_draft(&draft).unwrap();
        assert!(create_draft(&draft).is_err());
        drop(first);
        assert!(create_draft(&draft).is_ok());
    }
}
