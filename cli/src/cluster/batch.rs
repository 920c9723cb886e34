//! The jobs of a study: arrays of tasks, the scripts that they run, and the lines that hand them over.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::write_text;
use armid_workflow::study::Stage;

use super::array::Array;
use super::progress::stage_folder;
use super::{Submission, SubmittedJob};

/// What the last job is called, beside the stages.
const COLLECT: &str = "collect";

/// An array of tasks of one stage, or the last job.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    stage: Option<Stage>,
    array: Option<Array>,
}

/// Arrays for the tasks that are missing, in the order of stages, and the last job.
pub(crate) fn batches(designs: &[usize], runs: &[usize], max_array_size: usize) -> Vec<Batch> {
    let of = |stage, tasks: &[usize]| {
        Array::split(tasks, max_array_size)
            .into_iter()
            .map(move |array| Batch { stage: Some(stage), array: Some(array) })
            .collect::<Vec<_>>()
    };
    let mut batches = of(Stage::Designs, designs);
    batches.extend(of(Stage::Runs, runs));
    batches.push(Batch { stage: None, array: None });
    batches
}

/// Hands the batches over, each behind the stages before it: `take` gets each line and returns the number of the job,
/// `keep` stores what was taken before the next line is handed over.
///
/// # Errors
/// Those of `take` and `keep`.
pub(crate) fn submit(
    folder: &Path,
    submission: &mut Submission,
    batches: &[Batch],
    mut take: impl FnMut(&[String]) -> Result<String, Error>,
    mut keep: impl FnMut(&Submission) -> Result<(), Error>,
) -> Result<(), Error> {
    let attempt = submission.attempt() + 1;
    for batch in batches {
        let before: Vec<String> = submission
            .jobs
            .iter()
            .filter(|job| job.attempt == attempt && job.stage != batch.name())
            .map(|job| job.id.clone())
            .collect();
        let id = take(&batch.line(folder, &before, &submission.options))?;
        let tasks = batch.array.as_ref().map_or(Vec::new(), Array::tasks);
        submission.jobs.push(SubmittedJob { id, stage: batch.name().to_owned(), tasks, attempt });
        keep(submission)?;
    }
    Ok(())
}

impl Batch {
    fn name(&self) -> &'static str {
        self.stage.map_or(COLLECT, Stage::name)
    }

    /// Where its script is.
    pub(crate) fn script_path(&self, folder: &Path) -> PathBuf {
        folder.join("scripts").join(format!("{}.sh", self.name()))
    }

    /// The line that hands it over. It waits for the end of everything before it, however that ended: a task that failed
    /// would keep `afterok` from ever coming true, and the last job looks at what is there.
    pub(crate) fn line(&self, folder: &Path, before: &[String], options: &[String]) -> Vec<String> {
        // Not in the script: Slurm would cut a path there at a space.
        let output = format!("--output={}", self.log_pattern(folder));
        let mut line = vec!["sbatch".to_owned(), "--parsable".to_owned(), output];
        if let Some(array) = &self.array {
            line.push(format!("--array={}", array.text()));
        }
        if !before.is_empty() {
            line.push(format!("--dependency=afterany:{}", before.join(":")));
        }
        line.extend(options.iter().cloned());
        line.push(self.script_path(folder).display().to_string());
        if let Some(array) = &self.array {
            line.push(array.first.to_string());
        }
        line
    }

    /// Where its tasks print to, in Slurm's notation: `%` begins a number of the job, `%%` is one in the path.
    fn log_pattern(&self, folder: &Path) -> String {
        let number = if self.array.is_some() { "%A_%a" } else { "%j" };
        let logs = folder.join("logs").display().to_string().replace('%', "%%");
        format!("{logs}/{}-{number}.log", self.name())
    }

    /// Writes the script that its tasks run.
    ///
    /// # Errors
    /// [`Error`] where it cannot be written.
    pub(crate) fn write_script(&self, folder: &Path, submission: &Submission) -> Result<(), Error> {
        write_text(&self.script_path(folder), &self.script(folder, submission))
    }

    /// The script that its tasks run. A task that is begun again goes on with what its journal holds.
    pub(crate) fn script(&self, folder: &Path, submission: &Submission) -> String {
        let name = self.name();
        let head = format!(
            "#!/bin/bash\n#SBATCH --job-name=armid-{name}\n#SBATCH --open-mode=append\n#SBATCH --requeue\n\
             #SBATCH --cpus-per-task=1\nset -u\n"
        );
        let armid = quoted_path(&folder.join("armid"));
        let whole = quoted_path(folder);
        let Some(stage) = self.stage else {
            return format!("{head}exec {armid} --quiet study collect {whole}\n");
        };
        let tasks = match stage {
            Stage::Designs => submission.tasks.designs,
            Stage::Runs => submission.tasks.runs,
        };
        let study = quoted(&submission.study);
        let overrides: String = submission.overrides.iter().map(|word| format!(" {}", quoted(word))).collect();
        let designs = match stage {
            Stage::Designs => String::new(),
            Stage::Runs => format!(" --designs-from {}", quoted_path(&stage_folder(folder, Stage::Designs))),
        };
        let output = quoted_path(&stage_folder(folder, stage));
        format!(
            "{head}# $1: the number of the task at index 0.\ntask=$(($1 + SLURM_ARRAY_TASK_ID))\n\
             exec {armid} --quiet study {study}{overrides} --stage {name}{designs} --shard \"$task/{tasks}\" \\\n    \
             --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" --resume -o {output}/\"$task\"\n"
        )
    }
}

fn quoted_path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// A line to paste into a shell. The numbers of jobs that it waits for are `$JOB1` and so on.
pub(crate) fn shell_line(line: &[String]) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_=/.,:+@%".contains(&byte);
    let words = line.iter().map(|word| {
        let waits = word.starts_with("--dependency=afterany:$JOB");
        let plain = !word.is_empty() && word.bytes().all(|byte| is_plain(byte) || waits && byte == b'$');
        if plain { word.clone() } else { quoted(word) }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A word that a shell takes as it is.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn a_quote_in_a_word_stays_in_it() {
        assert_eq!(quoted("a 'b' $c"), r"'a '\''b'\'' $c'");
    }
}
