//! STUDY on the command line: a bundled name, a folder with a `study.toml`, or the file itself.

use std::path::{Path, PathBuf};

use armid::study::StudyPlan;
use armid_sim::Engine;
use miette::Result;

use crate::atomic_file::read_text;
use crate::bundled_experiments;
use crate::fault::{Fault, Text};
use crate::robot_source::located;
use crate::suggestion;

const FILE: &str = "study.toml";

/// The plan of a study, and the folder of its file where it is one: relative paths in it begin there.
pub(crate) fn load(name: &str) -> Result<(StudyPlan, Option<PathBuf>)> {
    let path = Path::new(name);
    let (text, folder) = if path.is_dir() {
        (read_text(&path.join(FILE))?, Some(path.to_path_buf()))
    } else if path.is_file() {
        (read_text(path)?, path.parent().map(Path::to_path_buf))
    } else {
        match bundled_experiments::find(name, FILE) {
            Some(entry) => (Text::new(format!("experiments/{}/{FILE}", entry.folder), entry.text), None),
            None => {
                let message = format!("study \"{name}\" is neither a bundled study, nor a folder, nor a file");
                return Err(Fault::new(message).help(suggestion::help(name, &bundled_experiments::names(FILE))).into());
            }
        }
    };
    let plan = StudyPlan::from_toml(&text.content).map_err(|fault| located(&text, &fault))?;
    plan.check_engines(&Engine::ALL.map(Engine::name))
        .map_err(|fault| located(&text, &fault.in_text(&text.content)))?;
    Ok((plan, folder))
}
