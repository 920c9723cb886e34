//! `armid study cancel`

use std::path::PathBuf;
use std::time::{Duration, Instant};

use miette::Result;

use crate::cluster::{Slurm, Submission};
use crate::terminal::{Answer, Console, Ending};

/// How long the end of the tasks is waited for, s: Slurm gives a task `KillWait`, 30 s as it comes, to end by itself.
const PATIENCE_S: u64 = 45;

/// Which study.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The folder of the submitted study
    folder: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let submission = Submission::read(&arguments.folder)?;
    let ids = submission.ids();
    Slurm.cancel(&ids)?;
    let begin = Instant::now();
    let mut active = true;
    while active && begin.elapsed() < Duration::from_secs(PATIENCE_S) {
        active = Slurm::are_active(&Slurm.states(&ids)?);
        if active {
            std::thread::sleep(Duration::from_millis(200));
        }
    }
    let jobs = ids.join(", ");
    let text = if active {
        format!("Jobs {jobs} were asked to end; Slurm does not report their end after {PATIENCE_S} s.\n")
    } else {
        format!("Jobs {jobs} have ended. What they finished is kept in {}.\n", arguments.folder.display())
    };
    console.answer(&Answer { text, json: serde_json::json!({ "jobs": ids, "ended": !active }) })?;
    Ok(if active { Ending::Negative } else { Ending::Done })
}
