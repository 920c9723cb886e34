//! How far a submitted study is, read from the journals of its tasks.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_workflow::study::{Part, PreparedStudy, Shard, Stage};

use super::{Submission, TaskCounts};

/// The folder of one task.
pub(crate) fn folder_of(folder: &Path, stage: Stage, task: usize) -> PathBuf {
    stage_folder(folder, stage).join(task.to_string())
}

/// The folder of a stage's tasks.
pub(super) fn stage_folder(folder: &Path, stage: Stage) -> PathBuf {
    folder.join("tasks").join(stage.name())
}

/// What is finished of a stage.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub(crate) struct StageProgress {
    /// Designs or runs that are kept.
    pub(crate) done: usize,
    /// Designs or runs in all.
    pub(crate) total: usize,
    /// Tasks that lack some, counted from one.
    pub(crate) missing_tasks: Vec<usize>,
}

/// What is finished of a study.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub(crate) struct Progress {
    pub(crate) designs: StageProgress,
    pub(crate) runs: StageProgress,
}

impl Progress {
    /// Reads the journals of all tasks. A journal that is not there yet, or that a kill cut within its first line, holds
    /// nothing.
    ///
    /// # Errors
    /// [`Error`] where a journal cannot be read or belongs to another study.
    pub(crate) fn read(folder: &Path, submission: &Submission, study: &PreparedStudy) -> Result<Self, Error> {
        let TaskCounts { designs, runs } = submission.tasks;
        Ok(Self {
            designs: stage_progress(folder, (Stage::Designs, designs), study)?,
            runs: stage_progress(folder, (Stage::Runs, runs), study)?,
        })
    }

    /// Is nothing missing?
    pub(crate) fn is_complete(&self) -> bool {
        self.designs.missing_tasks.is_empty() && self.runs.missing_tasks.is_empty()
    }
}

fn stage_progress(folder: &Path, (stage, n): (Stage, usize), study: &PreparedStudy) -> Result<StageProgress, Error> {
    let mut progress = StageProgress::default();
    for k in 1..=n {
        let part = Part { stage: Some(stage), shard: Some(Shard { k, n }) };
        let of_task = study.progress(&folder_of(folder, stage, k), part)?;
        progress.done += of_task.done;
        progress.total += of_task.total;
        if of_task.done < of_task.total {
            progress.missing_tasks.push(k);
        }
    }
    Ok(progress)
}
