//! The difference between two families of designs in one metric, with its interval.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::evidence::{Evidence, FamilyRuns, LEVEL, Run};
use super::family_score::VOLUME_RUNS;
use super::metric::Metric;
use crate::statistics::{Interval, bootstrap_interval, mean};

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
    pub(super) fn value(&self, metric: Metric, runs: &[Run<'_>]) -> Option<f64> {
        if runs.is_empty() {
            return None;
        }
        if metric == Metric::LogVolume {
            return self.log_volume(runs);
        }
        let logs: Vec<f64> = runs.iter().filter_map(|run| metric.of(run.estimate)).map(libm::log).collect();
        if logs.is_empty() {
            return None;
        }
        Some(libm::exp(mean(&logs)))
    }

    fn log_volume(&self, runs: &[Run<'_>]) -> Option<f64> {
        let columns: Vec<DVector<f64>> = runs.iter().map(|run| run.errors().component_div(self.units)).collect();
        if columns.len() <= self.parameters() {
            return None;
        }
        let z = DMatrix::from_columns(&columns);
        let moment = &z * z.transpose() / columns.len() as f64;
        Some(Cholesky::new(moment)?.l_dirty().diagonal().iter().map(|&d| libm::log(d)).sum())
    }

    pub(super) fn compare(
        &self,
        metric: Metric,
        estimator: &str,
        pair: [usize; 2],
        runs: &[FamilyRuns<'_>],
    ) -> Option<Comparison> {
        let pooled = pair.map(|family| runs[family].iter().flatten().copied().collect::<Vec<_>>());
        let [first, second] = [self.value(metric, &pooled[0])?, self.value(metric, &pooled[1])?];
        let difference = |a: f64, b: f64| if metric.is_logarithmic() { a - b } else { a / b };
        let sizes = pair.map(|family| runs[family].iter().map(Vec::len).collect::<Vec<_>>());
        let seed =
            self.seed.child(&format!("{estimator} {metric:?}"), (pair[0] * self.families.len() + pair[1]) as u64);
        // Draws with repetition hold fewer distinct runs, which makes a determinant of many parameters smaller than that of
        // all runs: without several runs for each parameter the interval would lie beside its own estimate.
        let few = |sizes: &[usize]| sizes.iter().sum::<usize>() < VOLUME_RUNS * self.parameters();
        let interval = if metric.is_logarithmic() && sizes.iter().any(|sizes| few(sizes)) {
            None
        } else {
            bootstrap_interval(&[&sizes[0], &sizes[1]], metric.resamples(), LEVEL, seed, |drawn| {
                let value = |side: usize| {
                    let picked: Vec<Run<'_>> =
                        drawn[side].iter().map(|&(design, run)| runs[pair[side]][design][run]).collect();
                    self.value(metric, &picked)
                };
                Some(difference(value(0)?, value(1)?))
            })
        };
        let none = if metric.is_logarithmic() { 0.0 } else { 1.0 };
        let difference = difference(first, second);
        let better = interval.filter(|i| !i.contains(none)).map(|_| usize::from(difference > none));
        Some(Comparison {
            metric,
            estimator: estimator.to_owned(),
            first: self.families[pair[0]].clone(),
            second: self.families[pair[1]].clone(),
            difference,
            interval,
            better: better.map(|side| self.families[pair[side]].clone()),
        })
    }
}
