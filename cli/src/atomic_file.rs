//! Files that are whole or absent.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use miette::Result;

use crate::fault::Fault;

/// Writes a file through a temporary one in the same folder, which takes its name at the end. Folders are made.
pub(crate) fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let fault = |error: std::io::Error| Fault::new(format!("{} cannot be written: {error}", path.display()));
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(fault)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".armid-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder).map_err(fault)?;
    let mut buffered: BufWriter<&File> = BufWriter::new(file.as_file());
    content(&mut buffered).and_then(|()| buffered.flush()).map_err(fault)?;
    drop(buffered);
    file.persist(path).map_err(|error| fault(error.error))?;
    Ok(())
}

/// Writes a text.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    write(path, |file| file.write_all(text.as_bytes()))
}

/// Reads a text, and says which file it is where that fails.
pub(crate) fn read_text(path: &Path) -> Result<crate::fault::Text> {
    let bytes = fs::read(path).map_err(|error| Fault::new(format!("{} cannot be read: {error}", path.display())))?;
    match String::from_utf8(bytes) {
        Ok(content) => Ok(crate::fault::Text::new(path.display().to_string(), content)),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
            Err(Fault::new(format!("{}:{line}: byte {at} is not UTF-8, expected text", path.display())).into())
        }
    }
}
