//! `armid study merge`

use std::path::{Path, PathBuf};

use armid::study::StudyPlan;
use armid_io::Error;
use armid_io::study::load_plan;
use armid_sim::Engine;
use miette::Result;

use super::request::output_folder;
use crate::study::{Part, Prepared};
use crate::terminal::{Console, Ending};

/// The folders of all parts.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folders of all parts
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
}

/// Puts parts together into the folder that the command line names, or into the plan's own.
pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let folders = &arguments.folders;
    let (plan, _) = load_plan(&folders[0].display().to_string(), &Engine::ALL.map(Engine::name))?;
    let output = output_folder(&plan, console)?;
    merge(plan, Some(&folders[0]), folders, &output, console)
}

/// Puts the parts of a study together; every piece must be there, since a merge performs nothing. Relative paths of the
/// plan begin at `beside`.
pub(super) fn merge(
    plan: StudyPlan,
    beside: Option<&Path>,
    folders: &[PathBuf],
    output: &Path,
    console: &Console,
) -> Result<Ending> {
    let place = |folder: &Path| folder.canonicalize().ok();
    if let Some(part) = folders.iter().find(|part| place(part).is_some_and(|part| place(output) == Some(part))) {
        let message = format!("the output folder {} is one of the parts, expected another folder", part.display());
        return Err(Error::mismatch(message).help("choose another folder with -o").into());
    }
    let prepared = Prepared::new(plan, beside)?;
    let study = prepared.performance(output, Part::default(), console);
    let mut work = study.with_work_from(folders)?;
    let missing = study.missing(&work);
    if missing > 0 {
        let message = format!("{missing} runs are in none of the folders, expected every part of the study, complete");
        return Err(Error::new(message).into());
    }
    study.begin(&mut work, false)?;
    match study.perform(work)? {
        Some(performed) => study.finish(performed),
        None => Ok(Ending::Interrupted),
    }
}
