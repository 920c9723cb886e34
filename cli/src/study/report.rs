//! The report of a study.

use std::path::{Path, PathBuf};

use armid::study::{ReportInput, RobotsSummary};
use armid_io::Error;
use armid_io::output::write_text;
use armid_reports::{Document, DocumentError, robots_document, study_document};

/// Draws the report of a study; returns the page.
pub(crate) fn write_report(folder: &Path, input: &ReportInput) -> Result<PathBuf, Error> {
    write_document(folder, &study_document(input).map_err(cannot_be_drawn)?)
}

/// Draws the page of one study on several robots; returns it.
pub(crate) fn write_robots_report(folder: &Path, summary: &RobotsSummary) -> Result<PathBuf, Error> {
    write_document(folder, &robots_document(summary).map_err(cannot_be_drawn)?)
}

fn write_document(folder: &Path, document: &Document) -> Result<PathBuf, Error> {
    let page = folder.join("report.html");
    for (name, svg) in document.svg_files().map_err(cannot_be_drawn)? {
        write_text(&folder.join(name), svg)?;
    }
    write_text(&page, &document.html().map_err(cannot_be_drawn)?)?;
    Ok(page)
}

fn cannot_be_drawn(error: DocumentError) -> Error {
    Error::new(format!("the report cannot be drawn: {error}"))
}
