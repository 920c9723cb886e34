//! The numbers of a figure over several studies, kept beside it.

use std::path::Path;

use armid::remedy::{Remedy, Setting, Task};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;
use crate::output::write_text;
use crate::text::Text;

/// Stores the numbers of a figure: of each robot one entry, each object that begins with a name on a line of its own.
///
/// # Errors
/// [`Error`] if they cannot be written.
pub fn write_figure_numbers<T: Serialize>(path: &Path, robots: &[T]) -> Result<(), Error> {
    let text = serde_json::to_string(robots).map_err(|error| Error::new(format!("numbers of a figure: {error}")))?;
    let text = ["effect", "criterion"].iter().fold(text, |text, key| {
        let from = format!("{{\"{key}\"");
        text.replace(&from, &format!("\n{from}"))
    });
    write_text(path, &(text + "\n"))
}

/// Reads the numbers of the figure `name` again.
///
/// # Errors
/// [`Error`] if the file cannot be read, or holds something else.
pub fn read_figure_numbers<T: DeserializeOwned>(path: &Path, name: &str) -> Result<Vec<T>, Error> {
    let text = Text::read(path)?;
    let help = || {
        let figure = Remedy::from("expected what ").perform(Task::Report, "").option(Setting::Figure, name);
        figure.say(" writes, or the folder of a study")
    };
    serde_json::from_str(&text.content).map_err(|error| Error::of_json(&text, &error).help(help()))
}
