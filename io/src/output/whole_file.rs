//! A file that is whole or absent.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::file_system::{Disk, FileSystem, folder_of};
use super::place::regular_file;
use crate::error::Error;

/// Writes a file through another one in the same folder, which takes its name at the end. Folders are made; links are
/// followed.
///
/// # Errors
/// [`Error`] where the folder or the file cannot be written, or something else than a file is there. What was there before
/// is as it was; only where the very last step fails, that of the folder to the disk, the new file is there.
pub fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    let place = regular_file(path)?;
    write_on(&Disk, &place, content).map_err(|error| Error::unwritable(path, &error))
}

/// Writes a text.
///
/// # Errors
/// As [`write()`].
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    write(path, |file| file.write_all(text.as_bytes()))
}

/// JSON with one key per line, and a final newline.
#[must_use]
pub fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}

/// The steps, on any file system: the content is on the disk before the name says that it is there.
pub(super) fn write_on<F: FileSystem>(
    system: &F,
    place: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let folder = folder_of(place);
    make_folders(system, folder)?;
    let mut draft = system.draft(folder, place)?;
    let mut buffered = BufWriter::new(&mut draft);
    content(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    system.sync(&draft)?;
    system.name(draft, place)?;
    system.sync_folder(folder)
}

/// Makes a folder and those above it that are missing; each is on the disk before anything is made in it.
fn make_folders<F: FileSystem>(system: &F, folder: &Path) -> io::Result<()> {
    if folder.as_os_str().is_empty() || system.is_folder(folder) {
        return Ok(());
    }
    make_folders(system, folder_of(folder))?;
    match system.make_folder(folder) {
        // Another process made it in the meantime.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists && system.is_folder(folder) => {}
        made => made?,
    }
    system.sync_folder(folder_of(folder))
}

/// Makes a folder and those above it that are missing.
pub(crate) fn make_folder(folder: &Path) -> io::Result<()> {
    make_folders(&Disk, folder)
}
