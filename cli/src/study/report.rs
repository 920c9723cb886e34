//! The report of a study.

use std::path::{Path, PathBuf};

use armid::study::ReportInput;
use armid_io::Error;
use armid_io::output::write_text;
use armid_reports::study_document;

/// Draws the report of a study; returns the page.
pub(crate) fn write_report(folder: &Path, input: &ReportInput) -> Result<PathBuf, Error> {
    let fault = |error: armid_reports::DocumentError| Error::new(format!("the report cannot be drawn: {error}"));
    let document = study_document(input).map_err(fault)?;
    let page = folder.join("report.html");
    for (name, svg) in document.svg_files().map_err(fault)? {
        write_text(&folder.join(name), svg)?;
    }
    write_text(&page, &document.html().map_err(fault)?)?;
    Ok(page)
}
