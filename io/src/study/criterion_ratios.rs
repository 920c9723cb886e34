//! The numbers of a figure over several studies, kept beside it.

use std::path::Path;

use armid::remedy::{Remedy, Setting, Task};
use armid::study::CriterionRatios;

use crate::error::Error;
use crate::output::write_text;
use crate::text::Text;

/// Stores the ratios of each robot, one comparison a line.
///
/// # Errors
/// [`Error`] if they cannot be written.
pub fn write_ratios(path: &Path, robots: &[CriterionRatios]) -> Result<(), Error> {
    let text = serde_json::to_string(robots).map_err(|error| Error::new(format!("ratios: {error}")))?;
    write_text(path, &(text.replace("{\"effect\"", "\n{\"effect\"") + "\n"))
}

/// Reads them again.
///
/// # Errors
/// [`Error`] if the file cannot be read, or holds something else.
pub fn read_ratios(path: &Path) -> Result<Vec<CriterionRatios>, Error> {
    let text = Text::read(path)?;
    let help = || {
        let figure = Remedy::from("expected what ").perform(Task::Report, "").with(Setting::Figure, "criteria");
        figure.say(" writes, or the folder of a study")
    };
    serde_json::from_str(&text.content).map_err(|error| Error::of_json(&text, &error).help(help()))
}
