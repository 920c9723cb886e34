//! The plan of a study by what it is called: a bundled name, a folder with a `study.toml`, or the file itself.

use std::path::{Path, PathBuf};

use armid::study::StudyPlan;

use crate::bundled_experiments;
use crate::error::Error;
use crate::suggestion;
use crate::text::Text;

const FILE: &str = "study.toml";

/// The plan of a study, and the folder of its file where it is one: relative paths in it begin there. `engines` are the
/// names of those that its conditions may ask for.
///
/// # Errors
/// [`Error`] where there is no such study, or its file is not as a study is written.
pub fn load(name: &str, engines: &[&'static str]) -> Result<(StudyPlan, Option<PathBuf>), Error> {
    let path = Path::new(name);
    let (text, folder) = if path.is_dir() {
        (Text::read(&path.join(FILE))?, Some(path.to_path_buf()))
    } else if path.is_file() {
        (Text::read(path)?, path.parent().map(Path::to_path_buf))
    } else {
        match bundled_experiments::find(name, FILE) {
            Some(entry) => (Text::new(format!("experiments/{}/{FILE}", entry.folder), entry.text), None),
            None => {
                let message = format!("study \"{name}\" is neither a bundled study, nor a folder, nor a file");
                return Err(Error::unknown(message).help(suggestion::help(name, &bundled_experiments::names(FILE))));
            }
        }
    };
    let plan = StudyPlan::from_toml(&text.content).map_err(|error| Error::of_format(&text, &error))?;
    plan.check_engines(engines).map_err(|error| Error::of_format(&text, &error.in_text(&text.content)))?;
    Ok((plan, folder))
}
