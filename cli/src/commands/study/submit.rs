//! `armid study submit`

use std::process::Command;

use armid_io::Error;
use armid_io::output::write_text;
use miette::Result;

use super::overrides::Overrides;
use crate::arguments::one_of;
use crate::terminal::{Answer, Console, Ending};

/// What hands the study over, and what every job runs.
const SCRIPT: &str = include_str!("slurm-study");

const AFTER_HELP: &str = "\
The folder of -o must be on a file system that all nodes share. Designs are one array of tasks, runs a \
second; a last job merges them, or submits again what is incomplete. squeue shows the jobs, scancel ends \
them; the same line resumes.

Examples:
  armid study submit 01-criteria --engine slurm --runs 1000 --array 200 -o /shared/01
  armid study submit S --engine slurm -o /shared/S -- --partition=long --mem=1G --time=2:00:00";

/// What to submit, and how.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// A bundled study, a folder with a study.toml, or the file itself
    study: String,
    /// The software of the cluster
    #[arg(long, value_name = "ENGINE", value_parser = one_of(&["slurm"], |name| name))]
    engine: &'static str,
    /// Split designs and runs into so many tasks, below the cluster's MaxArraySize
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    array: u32,
    #[command(flatten)]
    overrides: Overrides,
    /// Options of sbatch, behind --
    #[arg(last = true, value_name = "SBATCH OPTIONS")]
    options: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    // What cannot be read here cannot be performed there.
    let request = arguments.overrides.request(&arguments.study)?;
    request.single_plan(&format!("submit STUDY --engine {}", arguments.engine))?;
    let fault = |what: &str, error: &dyn std::fmt::Display| Error::new(format!("{what}: {error}"));
    let folder = request.output(console)?;
    let folder = std::path::absolute(&folder).map_err(|error| fault("the output folder", &error))?;
    let script = folder.join("slurm-study");
    write_text(&script, SCRIPT)?;
    let own = std::env::current_exe().map_err(|error| fault("the running program", &error))?;
    let mut bash = Command::new("bash");
    bash.env("ARMID", own).arg(&script).arg(&folder).args([&arguments.array.to_string(), &arguments.study]);
    bash.args(arguments.overrides.words()).arg("--").args(&arguments.options);
    let told = bash.output().map_err(|error| fault("bash", &error))?;
    if !told.status.success() {
        let said = String::from_utf8_lossy(&told.stderr).trim().to_owned();
        return Err(Error::new(said).help("submit on a machine where Slurm's programs are installed").into());
    }
    let text = String::from_utf8_lossy(&told.stdout).into_owned();
    console.show(&Answer { json: serde_json::json!({ "folder": folder, "submitted": text.trim() }), text })?;
    Ok(Ending::Done)
}
