//! The programs of Slurm that a study needs: `sbatch`, `squeue`, `scancel`, `scontrol`.

use std::process::{Command, Stdio};

use armid_io::Error;

use super::submission::is_job_number;

/// The states in which Slurm says that a job will do no more, by `squeue`'s words; a job that it has forgotten is none.
const ENDED: [&str; 9] =
    ["BOOT_FAIL", "CANCELLED", "COMPLETED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY", "REVOKED", "TIMEOUT"];

/// Slurm on this machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slurm;

impl Slurm {
    /// The word of the command line.
    pub(crate) const NAME: &'static str = "slurm";

    /// `MaxArraySize` where nothing else is configured, by `man slurm.conf`: indices stay below it.
    pub(crate) const USUAL_MAX_ARRAY_SIZE: usize = 1001;

    /// The largest array that this cluster takes.
    ///
    /// # Errors
    /// [`Error`] where no cluster answers.
    pub(crate) fn max_array_size(self) -> Result<usize, Error> {
        let configuration = answer_of(&["scontrol", "show", "config"].map(str::to_owned))?;
        let value =
            configuration.lines().find_map(|line| line.split_once('=').filter(|(key, _)| key.trim() == "MaxArraySize"));
        value
            .and_then(|(_, value)| value.trim().parse().ok())
            .ok_or_else(|| Error::new("scontrol show config: found no MaxArraySize, expected a whole number"))
    }

    /// Hands a job over by an `sbatch` line; its number.
    ///
    /// # Errors
    /// [`Error`] where it is refused.
    pub(crate) fn submit(self, line: &[String]) -> Result<String, Error> {
        let answer = answer_of(line)?;
        // `--parsable` prints the number, and a cluster's name behind a semicolon where there are several.
        let id = answer.trim().split(';').next().unwrap_or_default();
        if !is_job_number(id) {
            return Err(Error::new(format!("sbatch: found \"{}\", expected the number of a job", answer.trim())));
        }
        Ok(id.to_owned())
    }

    /// How many jobs or tasks of these are in which state. Arrays are counted task by task.
    ///
    /// # Errors
    /// [`Error`] where no cluster answers.
    pub(crate) fn states(self, ids: &[&str]) -> Result<Vec<(String, usize)>, Error> {
        let mut states: Vec<(String, usize)> = Vec::new();
        // All jobs are asked for: to name one that Slurm has forgotten is an error to squeue.
        let line = ["squeue", "--noheader", "--array", "--states=all", "--format=%F %T"].map(str::to_owned);
        for row in answer_of(&line)?.lines() {
            let Some((id, state)) = row.trim().split_once(' ') else { continue };
            if !ids.contains(&id) {
                continue;
            }
            match states.iter_mut().find(|(name, _)| name == state) {
                Some((_, count)) => *count += 1,
                None => states.push((state.to_owned(), 1)),
            }
        }
        states.sort();
        Ok(states)
    }

    /// Do some of them wait or run?
    pub(crate) fn are_active(states: &[(String, usize)]) -> bool {
        states.iter().any(|(state, _)| !ENDED.contains(&state.as_str()))
    }

    /// Asks for the end of jobs.
    ///
    /// # Errors
    /// [`Error`] where it is refused.
    pub(crate) fn cancel(self, ids: &[&str]) -> Result<(), Error> {
        let mut line = vec!["scancel".to_owned()];
        line.extend(ids.iter().map(|&id| id.to_owned()));
        answer_of(&line).map(|_| ())
    }
}

/// Standard output of a program that ended well.
fn answer_of(line: &[String]) -> Result<String, Error> {
    let program = &line[0];
    let output = Command::new(program).args(&line[1..]).stdin(Stdio::null()).output().map_err(|error| {
        Error::new(format!("{program} cannot be run: {error}"))
            .help("submit on a machine where Slurm's programs are installed, or look at the jobs by --dry-run")
    })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Error::new(format!("{} ended with {}: {}", line.join(" "), output.status, said.trim())));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
