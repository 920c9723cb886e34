//! What was submitted: `submission.json` in the folder of the study.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::{pretty, write_text};
use armid_io::text::Text;

/// How many tasks each stage is split into.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct TaskCounts {
    pub(crate) designs: usize,
    pub(crate) runs: usize,
}

/// One array or job that a cluster has taken.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct SubmittedJob {
    /// The cluster's number of it.
    pub(crate) id: String,
    /// `designs`, `runs` or `collect`.
    pub(crate) stage: String,
    /// The tasks in it, counted from one; none for the last job.
    pub(crate) tasks: Vec<usize>,
    /// Counted from one.
    pub(crate) attempt: usize,
}

/// A study that a cluster was given.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Submission {
    /// Which cluster software took it.
    pub(crate) engine: String,
    /// What the study is called on a command line: a bundled name or an absolute path.
    pub(crate) study: String,
    /// Where relative paths of its plan begin.
    pub(crate) beside: Option<PathBuf>,
    /// What stands in place of the plan's values, as words of a command line.
    pub(crate) overrides: Vec<String>,
    /// Options that the cluster software is given as they are.
    pub(crate) options: Vec<String>,
    /// How many tasks each stage has.
    pub(crate) tasks: TaskCounts,
    /// How often a task is submitted before the study is given up.
    pub(crate) attempts: usize,
    /// What the cluster has taken, in order.
    pub(crate) jobs: Vec<SubmittedJob>,
}

impl Submission {
    /// What the file is called.
    pub(crate) const NAME: &'static str = "submission.json";

    /// The submission in a folder.
    ///
    /// # Errors
    /// [`Error`] where there is none, it is no such file, or a job's number is none: programs of Slurm get it as an argument.
    pub(crate) fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(Self::NAME);
        if !path.is_file() {
            let message =
                format!("{}: found no {}, expected the folder of a submitted study", folder.display(), Self::NAME);
            return Err(Error::unknown(message).help("`armid study submit STUDY --engine slurm -o DIR` makes one"));
        }
        let text = Text::read(&path)?;
        let submission: Self = serde_json::from_str(&text.content).map_err(|error| {
            Error::new(format!("no submission of this version: {error}")).at_line(&text, error.line(), error.column())
        })?;
        match submission.jobs.iter().find(|job| !is_job_number(&job.id)) {
            Some(SubmittedJob { id, .. }) => {
                let written = serde_json::to_string(id).unwrap_or_default();
                let begin = text.content.find(&written).unwrap_or(0);
                let error = Error::new(format!("a job's id is {written}, expected digits, as sbatch gives them"));
                Err(error.at(&text, begin..begin + written.len(), "here"))
            }
            None => Ok(submission),
        }
    }

    /// Keeps it.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Error> {
        let value = serde_json::to_value(self).map_err(|error| Error::new(format!("the submission: {error}")))?;
        write_text(&folder.join(Self::NAME), &pretty(&value))
    }

    /// How often tasks have been submitted.
    pub(crate) fn attempt(&self) -> usize {
        self.jobs.iter().map(|job| job.attempt).max().unwrap_or(0)
    }

    /// The cluster's numbers of everything that it has taken.
    pub(crate) fn ids(&self) -> Vec<&str> {
        self.jobs.iter().map(|job| job.id.as_str()).collect()
    }
}

/// Is it the number that Slurm gives a job?
pub(super) fn is_job_number(id: &str) -> bool {
    !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_digit())
}
