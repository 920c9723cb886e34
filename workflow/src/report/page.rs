//! A document as files.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::write_text;
use armid_reports::{Document, DocumentError};

/// Writes the page and its figures into a folder; returns the page.
pub(super) fn write_document(folder: &Path, document: Result<Document, DocumentError>) -> Result<PathBuf, Error> {
    let (document, page) = (document.map_err(cannot_be_drawn)?, folder.join("report.html"));
    for (name, svg) in document.svg_files().map_err(cannot_be_drawn)? {
        write_text(&folder.join(name), svg)?;
    }
    write_text(&page, &document.html().map_err(cannot_be_drawn)?)?;
    Ok(page)
}

pub(super) fn cannot_be_drawn(error: DocumentError) -> Error {
    Error::new(format!("the report cannot be drawn: {error}"))
}
