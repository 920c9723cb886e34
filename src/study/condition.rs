//! The ways in which the experiments of a study are performed: a dimension beside designs and runs.
//!
//! Every run of every design is performed under every condition, with the same random streams, so that conditions are
//! compared in pairs. The first condition is the one that the figures of a study show.

use super::evidence::Findings;
use super::plan::StudyPlan;
use super::status_count::StatusCount;
use crate::experiment::Effects;

/// One way of performing the experiments: what differs is the simulated arm, never design, sensors' noise or estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Condition {
    /// Name in rows, tables and figures.
    pub name: String,
    /// Name of the engine that simulates the arm.
    pub engine: String,
    /// Effects of the real arm beside those of the plan and the truth.
    #[serde(default, skip_serializing_if = "Effects::is_none")]
    pub effects: Effects,
}

/// The results of all runs under one condition.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ConditionResult {
    /// The condition.
    pub condition: Condition,
    /// How the runs ended: every status that occurred, by name.
    pub statuses: Vec<StatusCount>,
    /// Scores and comparisons over these runs.
    pub findings: Findings,
}

impl StudyPlan {
    /// Every condition of the plan, in the order in which conditions are numbered.
    pub fn conditions(&self) -> Vec<Condition> {
        let none = [Effects::none()];
        let sets = if self.effect_sets.is_empty() { &none[..] } else { &self.effect_sets };
        let name = |engine: &String, index: usize, effects: &Effects| {
            let effects = self.condition_names.get(index).cloned().unwrap_or_else(|| effects.to_string());
            match (self.engines.len(), self.effect_sets.len()) {
                (_, 0) => engine.clone(),
                (1, _) => effects,
                _ => format!("{engine}, {effects}"),
            }
        };
        let condition = |engine: &String, index: usize, effects: &Effects| Condition {
            name: name(engine, index, effects),
            engine: engine.clone(),
            effects: effects.clone(),
        };
        let of = |engine| sets.iter().enumerate().map(move |(index, effects)| condition(engine, index, effects));
        self.engines.iter().flat_map(of).collect()
    }
}
