//! Two families over random truths: does the better one stay the better one on every arm?
//!
//! ```text
//! d_k = ln( value of the first / value of the second )    over the runs with truth k, k = 1 … K
//! ratio exp( mean d ), interval exp( mean d ± t_{K−1} s / √K )
//! ```
//! Truths are the units: designs, runs and noise are shared by the two families within each.

use super::estimator_runs::EstimatorRuns;
use super::evidence::{Evidence, LEVEL, RunValues};
use super::metric::Metric;
use crate::statistics::{Interval, mean, t_interval, wilson_interval};

/// The difference between two families in one metric over random truths.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TruthComparison {
    /// By what.
    pub metric: Metric,
    /// With which estimator.
    pub estimator: String,
    /// The first family.
    pub first: String,
    /// The second family.
    pub second: String,
    /// Number of truths.
    pub truths: usize,
    /// First over second, geometric mean over truths. Below 1: the first is better.
    pub ratio: f64,
    /// Its 95 % interval over truths.
    pub interval: Option<Interval>,
    /// The smallest and the largest ratio of one truth.
    pub range: Interval,
    /// For how many truths the first is better.
    pub first_better: usize,
    /// Wilson interval of that share.
    pub share_interval: Option<Interval>,
}

impl Evidence<'_> {
    /// `None` where no truths were drawn.
    pub(super) fn over_truths(
        &self,
        metric: Metric,
        runs: &EstimatorRuns<'_>,
        pair: [usize; 2],
        logs: &RunValues,
    ) -> Option<TruthComparison> {
        let of_truths = pair.map(|family| {
            let mut sums = vec![(0.0, 0_usize); self.truths + 1];
            for design in self.designs_of(family) {
                for (log, &truth) in logs[design].iter().zip(&runs.truths[design]) {
                    if let Some(log) = log {
                        sums[truth].0 += log;
                        sums[truth].1 += 1;
                    }
                }
            }
            sums
        });
        let value = |(sum, count): (f64, usize)| (count > 0).then(|| libm::exp(sum / count as f64));
        let logs: Vec<f64> = (1..=self.truths)
            .filter_map(|truth| Some(libm::log(value(of_truths[0][truth])? / value(of_truths[1][truth])?)))
            .collect();
        let least = logs.iter().copied().reduce(f64::min)?;
        let most = logs.iter().copied().reduce(f64::max)?;
        let first_better = logs.iter().filter(|&&log| log < 0.0).count();
        Some(TruthComparison {
            metric,
            estimator: runs.name.to_owned(),
            first: self.families[pair[0]].clone(),
            second: self.families[pair[1]].clone(),
            truths: logs.len(),
            ratio: libm::exp(mean(&logs)),
            interval: t_interval(&logs, LEVEL).map(Interval::exponentiated),
            range: Interval { low: least, high: most }.exponentiated(),
            first_better,
            share_interval: wilson_interval(first_better, logs.len(), LEVEL),
        })
    }
}
