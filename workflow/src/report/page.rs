//! A document as files.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::{write, write_text};
use armid_reports::{Document, DocumentError, Sheet};

/// Writes the page, and its figures for a sheet, into a folder; returns the page.
pub(super) fn write_document(
    folder: &Path,
    document: Result<Document, DocumentError>,
    sheet: Sheet,
) -> Result<PathBuf, Error> {
    let (document, page) = (document.map_err(cannot_be_drawn)?, folder.join("report.html"));
    for (name, content) in document.files(sheet).map_err(cannot_be_drawn)? {
        write(&folder.join(name), |file| file.write_all(&content))?;
    }
    write_text(&page, &document.html().map_err(cannot_be_drawn)?)?;
    Ok(page)
}

pub(super) fn cannot_be_drawn(error: DocumentError) -> Error {
    Error::new(format!("the report cannot be drawn: {error}"))
}
