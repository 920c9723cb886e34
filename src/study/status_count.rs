//! How the runs of a study ended.

use super::outcome::Outcome;

/// How many runs ended in one way.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct StatusCount {
    /// `ok`, or the kind of [`RunError`](super::RunError).
    pub status: String,
    /// Number of runs.
    pub runs: usize,
}

impl StatusCount {
    /// Counts the statuses of runs, sorted by name.
    pub fn count<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Vec<Self> {
        let mut counts = std::collections::BTreeMap::new();
        for outcome in outcomes {
            *counts.entry(outcome.status()).or_insert(0) += 1;
        }
        counts.into_iter().map(|(status, runs)| Self { status: status.to_owned(), runs }).collect()
    }
}
