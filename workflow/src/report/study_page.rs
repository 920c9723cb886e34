//! The report of a study.

use std::path::{Path, PathBuf};

use armid::study::{CriterionRatios, EffectLevels, ReportInput, RobotsSummary};
use armid_io::Error;
use armid_io::output::write;
use armid_io::study::write_figure_numbers;
use armid_reports::{DocumentError, Figure, Sheet, criteria_figure, levels_figure, robots_document, study_document};

use super::page::{cannot_be_drawn, write_document};

/// Draws the report of a study; returns the page.
///
/// # Errors
/// [`Error`] where a figure cannot be drawn or written.
pub fn write_report(folder: &Path, input: &ReportInput, sheet: Sheet) -> Result<PathBuf, Error> {
    write_document(folder, study_document(input), sheet)
}

/// Draws the page of one study on several robots; returns it.
///
/// # Errors
/// [`Error`] where a figure cannot be drawn or written.
pub fn write_robots_report(folder: &Path, summary: &RobotsSummary, sheet: Sheet) -> Result<PathBuf, Error> {
    write_document(folder, robots_document(summary), sheet)
}

/// Draws criteria under single effects on several robots, and stores the numbers beside the figure; returns the figure.
///
/// # Errors
/// [`Error`] where it cannot be drawn or written.
pub fn write_criteria(folder: &Path, robots: &[CriterionRatios], sheet: Sheet) -> Result<PathBuf, Error> {
    let path = write_figure(folder, &criteria_figure(robots), sheet)?;
    write_figure_numbers(&path.with_extension("json"), robots)?;
    Ok(path)
}

/// Draws criteria over the size of each effect, and stores the numbers of all beside the figures; returns the figures.
///
/// # Errors
/// [`Error`] if there is no effect with sizes, or where a figure cannot be drawn or written.
pub fn write_levels(folder: &Path, effects: &[EffectLevels], sheet: Sheet) -> Result<Vec<PathBuf>, Error> {
    if effects.is_empty() {
        let message = "no effect has a scenario without it and two sizes, each compared with d-optimal designs";
        return Err(Error::new(message));
    }
    let figures = effects.iter().map(|levels| write_figure(folder, &levels_figure(levels), sheet)).collect();
    write_figure_numbers(&folder.join("levels.json"), effects)?;
    figures
}

/// Draws a figure for a sheet; returns its SVG.
fn write_figure(folder: &Path, figure: &dyn Figure, sheet: Sheet) -> Result<PathBuf, Error> {
    let files = figure.draw(sheet).and_then(|drawing| drawing.files());
    for (name, content) in files.map_err(DocumentError::from).map_err(cannot_be_drawn)? {
        write(&folder.join(name), |file| file.write_all(&content))?;
    }
    Ok(folder.join(format!("{}.svg", figure.name())))
}
