//! `armid study status`

use std::path::{Path, PathBuf};
use std::time::Duration;

use armid_io::Error;
use armid_io::study::load_plan;
use armid_sim::Engine;
use armid_workflow::study::PreparedStudy;
use miette::Result;

use crate::cluster::{Progress, Slurm, Submission};
use crate::interrupt;
use crate::terminal::{Answer, Console, Ending};

/// How often the journals are looked at, s.
const WATCH_PERIOD_S: u64 = 5;

/// Which study.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folder of the submitted study
    folder: PathBuf,
    /// Update every 5 s until the study has ended; Ctrl-C leaves it running
    #[arg(long)]
    watch: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let folder = arguments.folder.as_path();
    let prepared = prepared(folder, &Submission::read(folder)?)?;
    loop {
        // Tasks that are submitted again come under new numbers.
        let submission = Submission::read(folder)?;
        let progress = Progress::read(folder, &submission, &prepared)?;
        // Where Slurm does not answer, the journals alone say how far the study is, and its end is not detected.
        let states = Slurm.states(&submission.ids());
        let merged = folder.join("summary.json").is_file();
        let ended = merged || states.as_ref().is_ok_and(|states| !Slurm::are_active(states));
        if !arguments.watch || ended || interrupt::asked() {
            console.answer(&answer(&progress, &states.ok(), merged))?;
            return Ok(if ended && !merged { Ending::Negative } else { Ending::Done });
        }
        console.note(line(&progress));
        for _ in 0..10 * WATCH_PERIOD_S {
            if interrupt::asked() {
                break;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

/// The study of a submission, prepared as its tasks prepare it.
pub(super) fn prepared(folder: &Path, submission: &Submission) -> Result<PreparedStudy, Error> {
    let (plan, _) = load_plan(&folder.display().to_string(), &Engine::ALL.map(Engine::name))?;
    PreparedStudy::new(plan, submission.beside.as_deref())
}

fn line(progress: &Progress) -> String {
    let Progress { designs, runs } = progress;
    format!("designs {}/{}, runs {}/{}", designs.done, designs.total, runs.done, runs.total)
}

fn answer(progress: &Progress, states: &Option<Vec<(String, usize)>>, merged: bool) -> Answer {
    let Progress { designs, runs } = progress;
    let jobs = match states {
        None => "Slurm did not answer".to_owned(),
        Some(states) if states.is_empty() => "none in Slurm".to_owned(),
        Some(states) => states
            .iter()
            .map(|(state, count)| format!("{count} {}", state.to_lowercase()))
            .collect::<Vec<_>>()
            .join(", "),
    };
    let text = format!(
        "designs  {} of {}, {} tasks incomplete\nruns     {} of {}, {} tasks incomplete\njobs     {jobs}\nresult   {}\n",
        designs.done,
        designs.total,
        designs.missing_tasks.len(),
        runs.done,
        runs.total,
        runs.missing_tasks.len(),
        if merged { "merged" } else { "not merged yet" },
    );
    let states: Option<serde_json::Map<_, _>> =
        states.as_ref().map(|states| states.iter().map(|(state, count)| (state.clone(), (*count).into())).collect());
    let json = serde_json::json!({ "designs": designs, "runs": runs, "jobs": states, "merged": merged });
    Answer { text, json }
}
