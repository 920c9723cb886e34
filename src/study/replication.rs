//! What is repeated independently where two families of designs are compared.
//!
//! A family is judged by its designs: the runs of one design share its trajectory, so that more of them say no more about the family.
//! Where a family has one design alone, its runs are repeated, and what is said is of that design.

use super::estimator_runs::EstimatorRuns;
use super::evidence::{Evidence, RunValues, present};
use super::shared_start::SharedStart;
use crate::statistics::mean;

/// What is repeated independently in a comparison of two families.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Replication {
    /// Pairs of designs, one of each family, that share their start.
    #[serde(rename = "paired designs")]
    PairedDesigns,
    /// Pairs of designs that share their start, and draws of the arm that all designs share.
    #[serde(rename = "paired designs and draws")]
    PairedDesignsAndDraws,
    /// Designs of either family.
    #[serde(rename = "designs")]
    Designs,
    /// Designs of one family, and runs of the only design of the other.
    #[serde(rename = "designs and runs")]
    DesignsAndRuns,
    /// Pairs of runs of two single designs, on the same arm or with the same noise.
    #[serde(rename = "paired runs")]
    PairedRuns,
    /// Runs of two single designs.
    #[serde(rename = "runs")]
    Runs,
    /// Designs, and the runs of each, drawn again from those that there are.
    #[serde(rename = "resampled designs and runs")]
    Resampled,
}

// Names in tables, those of stored results.
crate::input::named! { Replication as words {
    PairedDesigns: "paired designs", PairedDesignsAndDraws: "paired designs and draws", Designs: "designs",
    DesignsAndRuns: "designs and runs", PairedRuns: "paired runs", Runs: "runs", Resampled: "resampled designs and runs"
} }

/// The values of one family that count as independent, each with the place that its partner in another family has too.
#[derive(Debug)]
pub(super) struct Units {
    /// Whether they are designs, each the mean of its runs; runs of one design otherwise.
    pub(super) are_designs: bool,
    /// Values that are there, by place.
    values: Vec<(Place, f64)>,
    /// How many there would be if all runs gave an estimate.
    planned: usize,
}

/// Where a unit stands among those of its family.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Design(SharedStart),
    Run(usize),
}

impl Units {
    /// The values alone.
    pub(super) fn values(&self) -> Vec<f64> {
        self.values.iter().map(|(_, value)| *value).collect()
    }

    /// The differences from units of another family that are matched to these; `None` where fewer than two are.
    fn differences(&self, other: &Self) -> Option<Vec<f64>> {
        let partner = |place: &Place| other.values.iter().find(|(found, _)| found == place).map(|(_, value)| value);
        let is_matched = |place: &Place| *place != Place::Design(SharedStart::Fixed);
        let matched = self.values.iter().filter(|(place, _)| is_matched(place));
        let differences: Vec<f64> = matched.filter_map(|(place, value)| Some(value - partner(place)?)).collect();
        (differences.len() > 1).then_some(differences)
    }
}

impl Evidence<'_> {
    /// The independent values of a family: designs where it has several, else runs of its design; those that share noise count as one.
    pub(super) fn units_of(&self, family: usize, runs: &EstimatorRuns<'_>, logs: &RunValues) -> Units {
        let designs = self.designs_of(family);
        if let [design] = designs[..] {
            let values = runs
                .planned_groups(design)
                .enumerate()
                .filter_map(|(index, planned)| {
                    let of_group = present(&logs[design][runs.group(design, index)]);
                    (!of_group.is_empty()).then(|| (Place::Run(planned), mean(&of_group)))
                })
                .collect();
            let planned = self.runs.runs(design, self.condition);
            return Units { are_designs: false, values, planned };
        }
        let of_design = |&design: &usize| {
            let values = present(&logs[design]);
            (!values.is_empty()).then(|| (Place::Design(self.designs[design].start), mean(&values)))
        };
        Units { are_designs: true, values: designs.iter().filter_map(of_design).collect(), planned: designs.len() }
    }

    /// The differences of matched units, and of what: of designs that share their start, or of runs of two single designs that share
    /// arm or noise. `None` where units are independent of each other.
    pub(super) fn matched_differences(&self, [first, second]: [&Units; 2]) -> Option<(Replication, Vec<f64>)> {
        match (first.are_designs, second.are_designs) {
            (true, true) => Some((Replication::PairedDesigns, first.differences(second)?)),
            // Of unequally many runs the pairs would leave most of one side out.
            (false, false) if self.runs_are_matched && first.planned == second.planned => {
                Some((Replication::PairedRuns, first.differences(second)?))
            }
            (false, _) | (true, false) => None,
        }
    }
}
