//! The difference between two families of designs in one metric, with its interval.

use super::error::StudyError;
use super::estimator_runs::EstimatorRuns;
use super::evidence::{Evidence, LEVEL, RunValues, geometric_mean};
use super::family_score::VOLUME_RUNS;
use super::metric::Metric;
use super::volume::ErrorVolumes;
use crate::seed::Seed;
use crate::statistics::{Interval, bootstrap_interval};

/// The difference between two families of designs in one metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// The metric.
    pub metric: Metric,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the first family.
    pub first: String,
    /// Name of the second family.
    pub second: String,
    /// First over second; for a logarithmic metric first minus second. Below 1 (0): the first is better.
    pub difference: f64,
    /// Its 95 % interval.
    pub interval: Option<Interval>,
    /// The better family, where the interval excludes no difference.
    pub better: Option<String>,
}

impl Evidence<'_> {
    /// Compares two families by the logarithms of a metric; `None` where one of them has no value.
    pub(super) fn compare(
        &self,
        metric: Metric,
        runs: &EstimatorRuns<'_>,
        pair: [usize; 2],
        logs: &RunValues,
    ) -> Option<Comparison> {
        let designs = pair.map(|family| self.designs_of(family));
        let value = |side: usize| geometric_mean(designs[side].iter().flat_map(|&design| logs[design].iter().copied()));
        let (first, second) = (value(0)?, value(1)?);
        let sizes = designs.each_ref().map(|designs| designs.iter().map(|&d| runs.size(d)).collect::<Vec<_>>());
        let seed = self.pair_seed(metric, runs.name, pair);
        let interval = bootstrap_interval(&[&sizes[0], &sizes[1]], metric.resamples(), LEVEL, seed, |drawn| {
            let value = |side: usize| {
                let of_groups = drawn[side].iter().map(|&(d, group)| (designs[side][d], group));
                let of_runs = of_groups.flat_map(|(d, group)| runs.group(d, group).map(move |run| (d, run)));
                geometric_mean(of_runs.map(|(d, run)| logs[d][run]))
            };
            Some(value(0)? / value(1)?)
        });
        Some(self.comparison(metric, runs.name, pair, first / second, interval))
    }

    /// Compares the log volumes of the errors of two families.
    pub(super) fn compare_volumes(
        &self,
        runs: &EstimatorRuns<'_>,
        pair: [usize; 2],
    ) -> Result<Option<Comparison>, StudyError> {
        let metric = Metric::LogVolume;
        let designs = pair.map(|family| self.designs_of(family));
        let volumes = self.volumes(runs);
        let (Some(first), Some(second)) = (volumes.value(&designs[0])?, volumes.value(&designs[1])?) else {
            return Ok(None);
        };
        let sizes = designs.each_ref().map(|designs| designs.iter().map(|&d| runs.size(d)).collect::<Vec<_>>());
        // Draws with repetition hold fewer distinct runs, which makes a determinant of many parameters smaller than that of
        // all runs: without several runs for each parameter the interval would lie beside its own estimate.
        let few = sizes.iter().any(|sizes| sizes.iter().sum::<usize>() < VOLUME_RUNS * self.parameters());
        let interval = if few {
            None
        } else {
            let sides = [(&designs[0][..], &sizes[0][..]), (&designs[1][..], &sizes[1][..])];
            let seed = self.pair_seed(metric, runs.name, pair);
            volumes.interval(runs, &sides, metric.resamples(), LEVEL, seed, |values| Some(values[0]? - values[1]?))?
        };
        Ok(Some(self.comparison(metric, runs.name, pair, first - second, interval)))
    }

    /// The log volumes of the errors of runs.
    pub(super) fn volumes(&self, runs: &EstimatorRuns<'_>) -> ErrorVolumes<'_> {
        ErrorVolumes { runs: self.runs, condition: self.condition, estimator: runs.index, units: self.units }
    }

    fn pair_seed(&self, metric: Metric, estimator: &str, pair: [usize; 2]) -> Seed {
        self.seed.child(&format!("{estimator} {metric:?}"), (pair[0] * self.families.len() + pair[1]) as u64)
    }

    fn comparison(
        &self,
        metric: Metric,
        estimator: &str,
        pair: [usize; 2],
        difference: f64,
        interval: Option<Interval>,
    ) -> Comparison {
        let none = if metric.is_logarithmic() { 0.0 } else { 1.0 };
        let better = interval.filter(|i| !i.contains(none)).map(|_| usize::from(difference > none));
        Comparison {
            metric,
            estimator: estimator.to_owned(),
            first: self.families[pair[0]].clone(),
            second: self.families[pair[1]].clone(),
            difference,
            interval,
            better: better.map(|side| self.families[pair[side]].clone()),
        }
    }
}
