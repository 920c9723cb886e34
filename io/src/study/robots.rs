//! The summary of one study on several robots, above the folders of the robots.

use std::path::Path;

use armid::study::RobotsSummary;
use serde::de::IgnoredAny;

use crate::error::Error;
use crate::output::write_text;
use crate::text::Text;

const SUMMARY: &str = "summary.json";

/// What a summary is of, by its keys.
#[derive(serde::Deserialize)]
struct Kind {
    robots: Option<IgnoredAny>,
}

/// Stores the summary of one study on several robots.
///
/// # Errors
/// [`Error`] where it cannot be written.
pub fn write_robots(folder: &Path, summary: &RobotsSummary) -> Result<(), Error> {
    let mut text = serde_json::to_string(summary).map_err(|error| Error::new(format!("a summary: {error}")))?;
    text.push('\n');
    write_text(&folder.join(SUMMARY), &text)
}

/// Reads it again; `None` where the folder has no summary, or that of a study on one robot.
///
/// # Errors
/// [`Error`] where the summary cannot be read, or is cut or of another version.
pub fn read_robots(folder: &Path) -> Result<Option<RobotsSummary>, Error> {
    let path = folder.join(SUMMARY);
    if !path.is_file() {
        return Ok(None);
    }
    let text = Text::read(&path)?;
    let fault =
        |error: &serde_json::Error| Error::of_json(&text, error).help("expected a study that this version stored");
    let kind: Kind = serde_json::from_str(&text.content).map_err(|error| fault(&error))?;
    if kind.robots.is_none() {
        return Ok(None);
    }
    serde_json::from_str(&text.content).map(Some).map_err(|error| fault(&error))
}
