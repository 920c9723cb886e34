//! How well a design's own criterion value predicts the error that it achieves.

use super::evidence::Evidence;
use crate::statistics::{Spread, rank_correlation};

/// How well a design's own criterion value predicts the error that it achieves.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CriterionCorrelation {
    /// Name of the design's value.
    pub value: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Spearman's rank correlation over designs with the median prediction error.
    pub rank_correlation: Option<f64>,
    /// Number of designs.
    pub designs: usize,
}

impl Evidence<'_> {
    pub(super) fn criterion_correlations(
        &self,
        estimator: &str,
        spread: &[Option<Spread>],
    ) -> Vec<CriterionCorrelation> {
        let Some(first) = self.designs.first() else { return Vec::new() };
        (0..first.values.len())
            .map(|v| {
                let (x, y): (Vec<f64>, Vec<f64>) = self
                    .designs
                    .iter()
                    .zip(spread)
                    .filter_map(|(design, spread)| Some((design.values[v].1, spread.as_ref()?.median)))
                    .unzip();
                CriterionCorrelation {
                    value: first.values[v].0.to_owned(),
                    estimator: estimator.to_owned(),
                    rank_correlation: rank_correlation(&x, &y),
                    designs: x.len(),
                }
            })
            .collect()
    }
}
