//! How well a design's own criterion value predicts the errors that it achieves.

use super::evidence::{Evidence, LEVEL};
use super::metric::Metric;
use crate::statistics::{Interval, Spread, rank_correlation, rank_correlation_interval};

/// How well a design's own criterion value predicts the error that it achieves by one metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CriterionCorrelation {
    /// Name of the design's value.
    pub value: String,
    /// Name of the estimator.
    pub estimator: String,
    /// The metric of single runs.
    #[serde(default)]
    pub metric: Metric,
    /// Spearman's rank correlation over designs with the median over runs of the metric.
    pub rank_correlation: Option<f64>,
    /// Its 95 % interval, designs taken as independent; `None` of fewer than four, and of a correlation of ±1.
    #[serde(default)]
    pub interval: Option<Interval>,
    /// Number of designs.
    pub designs: usize,
}

impl Evidence<'_> {
    /// Every value of the designs against a metric of which `spread` is that over the runs of each design; nothing where none has it.
    pub(super) fn criterion_correlations(
        &self,
        estimator: &str,
        metric: Metric,
        spread: &[Option<Spread>],
    ) -> Vec<CriterionCorrelation> {
        let Some(first) = self.designs.first().filter(|_| spread.iter().any(Option::is_some)) else {
            return Vec::new();
        };
        (0..first.values.len())
            .map(|v| {
                let (x, y): (Vec<f64>, Vec<f64>) = self
                    .designs
                    .iter()
                    .zip(spread)
                    .filter_map(|(design, spread)| Some((design.values[v].1, spread.as_ref()?.median)))
                    .unzip();
                let rho = rank_correlation(&x, &y);
                CriterionCorrelation {
                    value: first.values[v].0.to_owned(),
                    estimator: estimator.to_owned(),
                    metric,
                    rank_correlation: rho,
                    interval: rho.and_then(|rho| rank_correlation_interval(rho, x.len(), LEVEL)),
                    designs: x.len(),
                }
            })
            .collect()
    }
}
