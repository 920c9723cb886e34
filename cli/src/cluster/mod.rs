//! A study on a cluster: the designs as one array of tasks, the runs as a second that waits for it, and a last job that
//! submits again what is missing or merges what is complete.
//!
//! Everything is in one folder on a file system that all nodes share:
//!
//! ```text
//! DIR/submission.json                     what was submitted, and under which job numbers
//! DIR/study.toml                          the plan
//! DIR/armid                               the binary that every task runs
//! DIR/scripts/*.sh                        the batch scripts
//! DIR/tasks/designs/K, DIR/tasks/runs/K   the journal of task K
//! DIR/logs/                               what the tasks printed
//! ```
//! and, once complete, the results of a study as anywhere else.

mod array;
mod batch;
mod progress;
mod slurm;
mod submission;

pub(crate) use batch::{Batch, batches, shell_line, submit};
pub(crate) use progress::{Progress, folder_of};
pub(crate) use slurm::Slurm;
pub(crate) use submission::{Submission, SubmittedJob, TaskCounts};
