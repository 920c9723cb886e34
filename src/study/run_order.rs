//! The order in which the runs of a study stand in its files: design by design, condition by condition, run by run.

use super::run_id::RunId;

/// The runs of a study in their order, without a list of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunOrder {
    conditions: usize,
    /// Runs of each design under one condition.
    runs: Vec<usize>,
    /// Position of the first run of each design, and of the end.
    first: Vec<usize>,
}

impl RunOrder {
    /// The order for designs with so many runs each, under so many conditions.
    #[must_use]
    pub fn new(runs: Vec<usize>, conditions: usize) -> Self {
        let mut first = vec![0];
        for &runs in &runs {
            first.push(first[first.len() - 1] + runs * conditions);
        }
        Self { conditions, runs, first }
    }

    /// How many runs there are.
    pub fn len(&self) -> usize {
        self.first[self.runs.len()]
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many conditions there are.
    pub const fn conditions(&self) -> usize {
        self.conditions
    }

    /// How many designs there are.
    pub fn designs(&self) -> usize {
        self.runs.len()
    }

    /// Runs of a design under one condition.
    pub fn runs(&self, design: usize) -> usize {
        self.runs[design]
    }

    /// The run at a position below [`RunOrder::len`].
    pub fn id(&self, position: usize) -> RunId {
        // Of designs without runs, which begin at the same position, the last one is meant.
        let design = self.first.partition_point(|&first| first <= position).saturating_sub(1);
        let within = position - self.first[design];
        let runs = self.runs[design];
        RunId { design, condition: within / runs, run: (within % runs) as u64 }
    }

    /// The position of a run of the study.
    pub fn position(&self, id: RunId) -> usize {
        self.first[id.design] + id.condition * self.runs[id.design] + id.run as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_positions_and_runs_in_the_order_of_their_fields() {
        let order = RunOrder::new(vec![3, 1, 4], 2);
        let ids: Vec<RunId> = (0..order.len()).map(|position| order.id(position)).collect();
        assert_eq!(ids.len(), 16);
        assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{ids:?}");
        for (position, &id) in ids.iter().enumerate() {
            assert_eq!(order.position(id), position);
            assert!(id.run < order.runs(id.design) as u64 && id.condition < order.conditions());
        }
    }
}
