//! `armid study merge`

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use armid::study::StudyPlan;
use armid_io::Error;
use armid_io::study::{Journal, Piece, load_plan};
use armid_sim::Engine;
use miette::Result;

use super::command::output_folder;
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
    let prepared = Prepared::new(plan, beside)?;
    let study = prepared.performance(output, Part::default(), console);
    let identity = study.identity()?;
    let (mut pieces, mut holder) = (Vec::new(), HashMap::new());
    for folder in folders {
        let found = Journal::read(&folder.join(Journal::NAME), &identity)?;
        for piece in &found {
            if let Piece::Run { outcome, .. } = piece
                && let Some(other) = holder.insert(outcome.id(), folder).filter(|other| *other != folder)
            {
                let message = format!(
                    "run {} of design {} is in {} and in {}, expected parts that do not overlap",
                    outcome.run,
                    outcome.design,
                    other.display(),
                    folder.display()
                );
                return Err(Error::new(message).into());
            }
        }
        pieces.extend(found);
    }
    study.check(&pieces)?;
    let missing = study.missing(&pieces);
    if missing > 0 {
        let message = format!("{missing} runs are in none of the folders, expected every part of the study, complete");
        return Err(Error::new(message).into());
    }
    let (mut journal, _) = study.journal(false)?;
    for piece in &pieces {
        journal.add(piece)?;
    }
    match study.perform(journal, pieces)? {
        Some(work) => study.finish(work),
        None => Ok(Ending::Interrupted),
    }
}
