//! The ways in which the experiments of a study are performed: a dimension beside designs and runs.
//!
//! Every run of every design is performed under every condition, with the same random streams, so that conditions are
//! compared in pairs. The first condition is the one that the figures of a study show.

use super::outcome::Outcome;
use super::plan::StudyPlan;
use super::summary::Findings;

/// One way of performing the experiments: what differs is the simulated arm, never design, sensors' noise or estimator.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Condition {
    /// Name in rows, tables and figures.
    pub name: String,
    /// Name of the engine that simulates the arm.
    pub engine: String,
}

/// What the runs under one condition say.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ConditionResult {
    /// The condition.
    pub condition: Condition,
    /// How the runs ended: every status that occurred, by name.
    pub statuses: Vec<StatusCount>,
    /// What the runs together say.
    pub findings: Findings,
}

/// How many runs ended in one way.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct StatusCount {
    /// `ok`, or the kind of [`Failure`](super::Failure).
    pub status: String,
    /// Number of runs.
    pub runs: usize,
}

impl StatusCount {
    /// Counts the statuses of runs, sorted by name.
    #[must_use]
    pub fn of<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Vec<Self> {
        let mut counts = std::collections::BTreeMap::new();
        for outcome in outcomes {
            *counts.entry(outcome.status()).or_insert(0) += 1;
        }
        counts.into_iter().map(|(status, runs)| Self { status: status.to_owned(), runs }).collect()
    }
}

impl StudyPlan {
    /// Every condition of the plan, in the order in which conditions are numbered.
    #[must_use]
    pub fn conditions(&self) -> Vec<Condition> {
        self.engines.iter().map(|engine| Condition { name: engine.clone(), engine: engine.clone() }).collect()
    }
}
