//! Parts of a study: a stage, a share of it, or all.

use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting, Task};
use armid::study::StudySetup;
use armid_io::Error;
use armid_io::study::{FinishedWork, Journal};

/// What a study does first and second. Designs are made once; every run needs them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// The trajectories.
    Designs,
    /// Experiments, estimates and scores.
    Runs,
}

armid::input::named! { Stage { Designs: "designs", Runs: "runs" } }

/// Share `k` of `n`, counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Shard {
    /// Which, from one.
    pub k: usize,
    /// Of how many.
    pub n: usize,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((k, n)) if 1 <= k && k <= n => Ok(Self { k, n }),
            _ => Err("expected K/N with 1 ≤ K ≤ N, as 2/8".to_owned()),
        }
    }
}

/// A part of a study: one stage or both, and a share of it or all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Part {
    /// The stage, or both.
    pub stage: Option<Stage>,
    /// The share, or all.
    pub shard: Option<Shard>,
}

impl Part {
    /// Does the work at this place of the stage's list belong to it?
    pub fn holds(self, position: usize) -> bool {
        self.shard.is_none_or(|shard| position % shard.n == shard.k - 1)
    }

    /// Is it the whole study, to be summed up?
    pub fn is_whole(self) -> bool {
        self.shard.is_none() && self.stage != Some(Stage::Designs)
    }
}

/// Adds the designs that a folder holds, or the folders in it.
///
/// # Errors
/// [`Error`] where it holds none, or those of another study.
pub(super) fn designs_from(folder: &Path, work: &mut FinishedWork, setup: &StudySetup) -> Result<(), Error> {
    let journals = journals_in(folder)?;
    if journals.is_empty() {
        let message = format!("{}: found no {}, expected a folder with designs", folder.display(), Journal::NAME);
        return Err(Error::new(message).help(make_designs()));
    }
    journals.iter().try_for_each(|journal| work.include_designs(journal, setup))
}

/// What makes the designs of a study.
pub(super) fn make_designs() -> Remedy {
    let help = Remedy::task(Task::Study, "STUDY").option(Setting::Stage, "designs").option(Setting::Output, "DIR");
    help.say(" makes them")
}

/// The journal of a folder, or those of the folders in it, in the order of their names.
fn journals_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let own = folder.join(Journal::NAME);
    if own.is_file() {
        return Ok(vec![own]);
    }
    let fault = |error: std::io::Error| Error::new(format!("{} cannot be read: {error}", folder.display()));
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fault)? {
        let journal = entry.map_err(fault)?.path().join(Journal::NAME);
        if journal.is_file() {
            found.push(journal);
        }
    }
    found.sort();
    Ok(found)
}
