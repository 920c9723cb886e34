//! The runs that gave an estimate, and which of them share their noise.

use std::ops::Range;

use crate::statistics::mean;

/// The runs that gave an estimate with one estimator: design → run.
#[derive(Debug)]
pub(super) struct EstimatorRuns<'a> {
    pub(super) index: usize,
    pub(super) name: &'a str,
    /// Which runs gave one.
    scored: Vec<Vec<bool>>,
    /// Index of the truth of each run that gave one.
    pub(super) truths: Vec<Vec<usize>>,
    /// Where runs share noise, the first run of each group that does, among those that gave an estimate, and their number.
    groups: Option<Vec<Vec<usize>>>,
    /// So many planned runs in succession share their noise.
    runs_of_noise: usize,
}

impl<'a> EstimatorRuns<'a> {
    /// Of the planned runs of each design: which gave an estimate, and the truth of those that did; so many in succession share
    /// their noise.
    pub(super) fn new(
        index: usize,
        name: &'a str,
        scored: Vec<Vec<bool>>,
        truths: Vec<Vec<usize>>,
        runs_of_noise: usize,
    ) -> Self {
        let groups = (runs_of_noise > 1).then(|| scored.iter().map(|of| first_of_groups(of, runs_of_noise)).collect());
        Self { index, name, scored, truths, groups, runs_of_noise }
    }

    /// Which planned runs of a design gave an estimate.
    pub(super) fn scored(&self, design: usize) -> &[bool] {
        &self.scored[design]
    }

    /// How many runs of a design gave an estimate.
    pub(super) fn count(&self, design: usize) -> usize {
        self.truths[design].len()
    }

    /// How many groups of them have noise of their own.
    pub(super) fn size(&self, design: usize) -> usize {
        self.groups.as_ref().map_or(self.count(design), |groups| groups[design].len() - 1)
    }

    /// The runs of one such group, among those that gave an estimate.
    pub(super) fn group(&self, design: usize, index: usize) -> Range<usize> {
        self.groups.as_ref().map_or(index..index + 1, |groups| groups[design][index]..groups[design][index + 1])
    }

    /// Where each such group of a design stands among the planned ones.
    pub(super) fn planned_groups(&self, design: usize) -> impl Iterator<Item = usize> {
        let planned = self.scored[design].chunks(self.runs_of_noise).enumerate();
        planned.filter(|(_, of_group)| of_group.contains(&true)).map(|(place, _)| place)
    }

    /// The mean of each group of a design's values.
    pub(super) fn group_means(&self, design: usize, values: &[f64]) -> Vec<f64> {
        (0..self.size(design)).map(|index| mean(&values[self.group(design, index)])).collect()
    }
}

/// The place among the runs that gave an estimate of the first of every `size` planned ones, where some did; and their number.
fn first_of_groups(scored: &[bool], size: usize) -> Vec<usize> {
    let mut first = vec![0];
    for group in scored.chunks(size) {
        let before = first[first.len() - 1];
        match group.iter().filter(|&&scored| scored).count() {
            0 => {}
            some => first.push(before + some),
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_groups_hold_the_runs_that_gave_an_estimate() {
        // Pairs: both, one, none, both, the last without its other.
        let scored = [true, true, false, true, false, false, true, true, true];
        let groups = first_of_groups(&scored, 2);
        assert_eq!(groups, [0, 2, 3, 5, 6]);
        let runs = EstimatorRuns {
            index: 0,
            name: "ols",
            scored: vec![scored.to_vec()],
            truths: vec![vec![0; 6]],
            groups: Some(vec![groups]),
            runs_of_noise: 2,
        };
        assert_eq!((runs.count(0), runs.size(0)), (6, 4));
        assert_eq!(runs.group(0, 2), 3..5);
        assert_eq!(runs.group_means(0, &[1.0, 3.0, 5.0, 7.0, 8.0, 9.0]), [2.0, 5.0, 7.5, 9.0]);
        assert_eq!(runs.planned_groups(0).collect::<Vec<_>>(), [0, 1, 3, 4]);
        let alone = EstimatorRuns { groups: None, runs_of_noise: 1, ..runs };
        assert_eq!((alone.size(0), alone.group(0, 2)), (6, 2..3));
        assert_eq!(alone.planned_groups(0).collect::<Vec<_>>(), [0, 1, 3, 6, 7, 8]);
    }
}
