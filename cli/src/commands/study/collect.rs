//! `armid study collect`

use std::path::{Path, PathBuf};

use armid_io::study::load_plan;
use armid_sim::Engine;
use armid_workflow::study::{Stage, merge};
use miette::Result;

use super::answer::show;
use super::status::prepared;
use crate::cluster::{Progress, Slurm, Submission, batches, folder_of, submit};
use crate::terminal::{Answer, Console, Ending, Watch};

/// Which study.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folder of the submitted study
    folder: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let folder = arguments.folder.as_path();
    let mut submission = Submission::read(folder)?;
    let prepared = prepared(folder, &submission)?;
    let progress = Progress::read(folder, &submission, &prepared)?;
    if progress.is_complete() {
        return merge_all(folder, &submission, console);
    }
    let (designs, runs) = (&progress.designs.missing_tasks, &progress.runs.missing_tasks);
    let json = serde_json::json!({ "missing": progress, "attempts": submission.attempt() });
    if submission.attempt() >= submission.attempts {
        let text = format!(
            "Given up after {} attempts: designs tasks {designs:?} and runs tasks {runs:?} are incomplete.\n\
             What they said is in {}; armid study submit in another folder begins anew.\n",
            submission.attempt(),
            folder.join("logs").display(),
        );
        console.show(&Answer { text, json })?;
        return Ok(Ending::Negative);
    }
    let batches = batches(designs, runs, Slurm.max_array_size()?);
    let take = |line: &[String]| Slurm.submit(line);
    submit(folder, &mut submission, &batches, take, |submission| submission.write(folder))?;
    let text = format!(
        "Designs tasks {designs:?} and runs tasks {runs:?} were incomplete and are submitted again, attempt {} of {}.\n",
        submission.attempt(),
        submission.attempts
    );
    console.show(&Answer { text, json })?;
    Ok(Ending::Done)
}

/// Puts the parts of all tasks together in the folder itself.
fn merge_all(folder: &Path, submission: &Submission, console: &Console) -> Result<Ending> {
    let (plan, _) = load_plan(&folder.display().to_string(), &Engine::ALL.map(Engine::name))?;
    let of = |stage, count| (1..=count).map(move |task| folder_of(folder, stage, task));
    let parts: Vec<PathBuf> =
        of(Stage::Designs, submission.tasks.designs).chain(of(Stage::Runs, submission.tasks.runs)).collect();
    show(&merge(plan, submission.beside.as_deref(), &parts, folder, &Watch::new(console))?, console)
}
