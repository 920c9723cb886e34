//! `armid study submit`

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::write_text;
use armid_io::study::plan_text;
use armid_workflow::study::PreparedStudy;
use miette::Result;

use super::overrides::Overrides;
use crate::arguments::one_of;
use crate::cluster::{Batch, Slurm, Submission, TaskCounts, batches, shell_line, submit};
use crate::terminal::{Answer, Console, Ending};

/// So many runs make one task where nothing else is asked for: at 0.2 s each, far more than what a task costs to begin.
const RUNS_PER_TASK: usize = 50;

/// More tasks are made only where `--array` asks for them: `MaxArraySize` of Slurm is 1001 as it comes.
const USUAL_MAX_TASKS: usize = 1000;

const AFTER_HELP: &str = "\
The folder of -o must be on a file system that all nodes share. Designs are one array of tasks, runs a second that
waits for it; the last job submits again what is missing, and merges and reports what is complete.

Examples:
  armid study submit 01-criteria --engine slurm --runs 1000 --array 200 -o /shared/01
  armid study submit 01-criteria --engine slurm --dry-run                 prints scripts and sbatch lines
  armid study submit my/study.toml --engine slurm -o /shared/my -- --partition=long --mem=1G --time=2:00:00
  armid study status /shared/01 --watch                                   Ctrl-C leaves the study running";

/// What to submit, and how.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// A bundled study, a folder with a study.toml, or the file itself
    study: String,
    /// The software of the cluster
    #[arg(long, value_name = "ENGINE", value_parser = one_of(&[Slurm], |_| Slurm::NAME))]
    engine: Slurm,
    /// Print the scripts and the lines that would hand them over, and submit nothing
    #[arg(long)]
    dry_run: bool,
    /// Split the runs into so many tasks; one for every 50 runs where absent, at most 1000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    array: Option<u32>,
    /// Submit a task at most so often
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    attempts: u32,
    #[command(flatten)]
    overrides: Overrides,
    /// Options of sbatch, behind --
    #[arg(last = true, value_name = "SBATCH OPTIONS")]
    options: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let request = arguments.overrides.request(&arguments.study)?;
    let plan = request.one("submit STUDY --engine slurm")?.clone();
    let folder = absolute(&request.output(console)?)?;
    if folder.to_string_lossy().contains(char::is_control) {
        let message =
            format!("the output folder is {folder:?}, expected a path without line breaks and control characters");
        return Err(Error::new(message).help("choose another folder with -o").into());
    }
    let beside = request.beside;
    let text = plan_text(&plan)?;
    // What cannot be prepared here cannot be performed there.
    let study = PreparedStudy::new(plan, beside.as_deref())?;
    let (designs, runs) = (study.designs(), study.runs());
    let usual = runs.div_ceil(RUNS_PER_TASK).min(USUAL_MAX_TASKS);
    let tasks = arguments.array.map_or(usual, |tasks| tasks as usize).clamp(1, runs);
    let path = Path::new(&arguments.study);
    let mut submission = Submission {
        engine: Slurm::NAME.to_owned(),
        study: if path.exists() { absolute(path)?.display().to_string() } else { arguments.study.clone() },
        beside: beside.as_deref().map(absolute).transpose()?,
        overrides: arguments.overrides.words(),
        options: arguments.options.clone(),
        tasks: TaskCounts { designs: tasks.min(designs), runs: tasks },
        attempts: arguments.attempts as usize,
        jobs: Vec::new(),
    };
    let max_array_size = match arguments.engine.max_array_size() {
        Ok(size) => size,
        Err(_) if arguments.dry_run => Slurm::USUAL_MAX_ARRAY_SIZE,
        Err(error) => return Err(error.into()),
    };
    let all = |count: usize| (1..=count).collect::<Vec<_>>();
    let batches = batches(&all(submission.tasks.designs), &all(submission.tasks.runs), max_array_size);
    if arguments.dry_run {
        console.show(&shown(&folder, &submission, &batches)?)?;
        return Ok(Ending::Done);
    }
    if folder.join(Submission::NAME).exists() {
        let message = format!("{} holds a submitted study already", folder.display());
        let help = "see armid study status, end it by armid study cancel, or choose another folder with -o";
        return Err(Error::mismatch(message).help(help).into());
    }
    study.check_output(&folder)?;
    std::fs::create_dir_all(folder.join("logs"))
        .map_err(|error| Error::new(format!("{} cannot be written: {error}", folder.display())))?;
    write_text(&folder.join("study.toml"), &text)?;
    keep_binary(&folder)?;
    for batch in &batches {
        batch.write_script(&folder, &submission)?;
    }
    submission.write(&folder)?;
    let take = |line: &[String]| arguments.engine.submit(line);
    submit(&folder, &mut submission, &batches, take, |submission| submission.write(&folder))?;
    console.show(&Answer {
        text: format!(
            "{designs} designs in {} tasks and {runs} runs in {} tasks are submitted as jobs {}.\n\
             Follow them by armid study status {} --watch\n",
            submission.tasks.designs,
            submission.tasks.runs,
            submission.ids().join(", "),
            folder.display()
        ),
        json: serde_json::json!({ "folder": folder, "tasks": submission.tasks, "jobs": submission.jobs }),
    })?;
    Ok(Ending::Done)
}

/// Every task runs the binary that submitted it, even if another one is built meanwhile.
fn keep_binary(folder: &Path) -> Result<(), Error> {
    let copy = folder.join("armid");
    std::env::current_exe()
        .and_then(|own| std::fs::copy(own, &copy))
        .map(|_| ())
        .map_err(|error| Error::new(format!("{} cannot be written: {error}", copy.display())))
}

/// What would be submitted, as a shell script: each line gives the number of its job to those that wait for it.
fn shown(folder: &Path, submission: &Submission, batches: &[Batch]) -> Result<Answer, Error> {
    let mut text = String::new();
    let mut scripts = serde_json::Map::new();
    for batch in batches {
        let path = batch.script_path(folder).display().to_string();
        if !scripts.contains_key(&path) {
            let script = batch.script(folder, submission);
            let _ = writeln!(text, "# {path}\n{script}");
            scripts.insert(path, script.into());
        }
    }
    let mut lines = Vec::new();
    let take = |line: &[String]| {
        lines.push(shell_line(line));
        Ok(format!("$JOB{}", lines.len()))
    };
    submit(folder, &mut submission.clone(), batches, take, |_| Ok(()))?;
    for (index, line) in lines.iter().enumerate() {
        let _ = writeln!(text, "JOB{}=$({line})", index + 1);
    }
    let json = serde_json::json!({ "scripts": scripts, "lines": lines, "tasks": submission.tasks });
    Ok(Answer { text, json })
}

fn absolute(path: &Path) -> Result<PathBuf, Error> {
    // The folder of a file that is named without one.
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::path::absolute(path).map_err(|error| Error::new(format!("{}: {error}", path.display())))
}
