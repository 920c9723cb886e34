//! Every file that armid writes at once is written here: whole or absent, and only where a file may be.
//!
//! Recordings, which grow for minutes, are the one exception: they are written as `R.mcap.part` beside their place and
//! take their name at the end ([`crate::recording`]).

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::error::Error;

/// Writes a file through a temporary one in the same folder, which takes its name at the end. Folders are made.
///
/// # Errors
/// [`Error`] where the folder or the file cannot be written; what was there before is as it was.
pub fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<(), Error> {
    let unwritable = |error: std::io::Error| Error::unwritable(path, &error);
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(unwritable)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".armid-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder).map_err(unwritable)?;
    let mut buffered: BufWriter<&File> = BufWriter::new(file.as_file());
    content(&mut buffered).and_then(|()| buffered.flush()).map_err(unwritable)?;
    drop(buffered);
    file.persist(path).map_err(|error| unwritable(error.error))?;
    Ok(())
}

/// Writes a text.
///
/// # Errors
/// As [`write()`].
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    write(path, |file| file.write_all(text.as_bytes()))
}

/// Writes a value as JSON, one key per line, with a final newline.
///
/// # Errors
/// As [`write()`].
pub fn write_json(path: &Path, value: &serde_json::Value) -> Result<(), Error> {
    write_text(path, &pretty(value))
}

/// JSON with one key per line, and a final newline.
#[must_use]
pub fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}
