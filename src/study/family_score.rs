//! The score of a family of designs, in all and parameter by parameter.

use super::evidence::{Evidence, FamilyRuns, LEVEL, Run};
use super::metric::Metric;
use crate::statistics::{
    Interval, Spread, bootstrap_interval, mean, quantile, root_mean_square, t_interval, variance, wilson_interval,
};

/// Runs for each parameter from which on a volume has an interval.
pub(super) const VOLUME_RUNS: usize = 4;

/// The score of a family of designs with one estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FamilyScore {
    /// Name of the family.
    pub family: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Number of designs.
    pub designs: usize,
    /// Runs that gave an estimate, over all designs.
    pub runs: usize,
    /// Runs that did not.
    pub failures: usize,
    /// One value per metric, in the order of [`Metric::ALL`]; `None` where it is not defined (a volume needs more runs
    /// than parameters).
    pub values: Vec<Option<f64>>,
    /// Their 95 % intervals by bootstrap over designs and runs; `None` too where a volume has fewer than four runs for
    /// each parameter, since draws with repetition would make it singular.
    pub intervals: Vec<Option<Interval>>,
    /// Median over parameters of the standard deviation over its Cramér–Rao bound.
    pub std_over_bound: Option<f64>,
    /// Median over parameters of the Cramér–Rao standard deviation in reference units.
    pub bound_in_units: Option<f64>,
    /// Spread over runs of the torque prediction RMSE, N·m.
    pub prediction_spread: Option<Spread>,
    /// Spread over runs of the parameter RMSE in reference units.
    pub reference_spread: Option<Spread>,
    /// One entry per base parameter.
    pub parameters: Vec<ParameterScore>,
    /// Share of all parameters and runs whose stated 95 % interval holds the truth.
    pub coverage: f64,
}

impl FamilyScore {
    /// The bound of one experiment where `experiments` make up the whole, `bound √k`: as long as it falls, an experiment
    /// gains more than the same number of samples of those before it; where it stands still, the design has nothing left
    /// to add.
    #[must_use]
    pub fn bound_per_experiment(&self, experiments: usize) -> Option<f64> {
        self.bound_in_units.map(|bound| bound * libm::sqrt(experiments as f64))
    }
}

/// The score of a family on one base parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ParameterScore {
    /// Mean error, in the parameter's unit.
    pub bias: f64,
    /// Its 95 % interval.
    pub bias_interval: Option<Interval>,
    /// Standard deviation over the runs of a design, root of the mean variance over designs.
    pub std: f64,
    /// Mean standard deviation that the estimator states.
    pub stated_std: f64,
    /// Cramér–Rao bound on the standard deviation, root of the mean bound over designs.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub bound_std: f64,
    /// Root of the mean square error.
    pub rmse: f64,
    /// Share of runs whose stated 95 % interval holds the truth.
    pub coverage: f64,
    /// Wilson interval of that share.
    pub coverage_interval: Option<Interval>,
    /// Spread of the error over runs, in the parameter's unit.
    pub spread: Option<Spread>,
}

impl Evidence<'_> {
    pub(super) fn family_score(&self, family: usize, estimator: &str, runs: &FamilyRuns<'_>) -> FamilyScore {
        let all: Vec<Run<'_>> = runs.iter().flatten().copied().collect();
        let of = |metric: Metric| all.iter().filter_map(|run| metric.of(run.estimate)).collect::<Vec<_>>();
        let designs = self.designs.iter().filter(|design| design.family == family);
        let planned = self.outcomes.iter().filter(|outcome| self.designs[outcome.design].family == family).count();
        let parameters = self.parameter_scores(family, runs);
        let over_bound: Vec<f64> = parameters.iter().map(|p| p.std / p.bound_std).filter(|r| r.is_finite()).collect();
        let in_units: Vec<f64> = parameters.iter().zip(self.units.iter()).map(|(p, unit)| p.bound_std / unit).collect();
        FamilyScore {
            family: self.families[family].clone(),
            estimator: estimator.to_owned(),
            designs: designs.count(),
            runs: all.len(),
            failures: planned - all.len(),
            values: Metric::ALL.map(|metric| self.value(metric, &all)).to_vec(),
            intervals: Metric::ALL.map(|metric| self.value_interval(metric, family, estimator, runs)).to_vec(),
            std_over_bound: quantile(&over_bound, 0.5),
            bound_in_units: quantile(&in_units, 0.5).filter(|value| value.is_finite()),
            prediction_spread: Spread::of(&of(Metric::Prediction)),
            reference_spread: Spread::of(&of(Metric::Reference)),
            coverage: mean(&parameters.iter().map(|p| p.coverage).collect::<Vec<_>>()),
            parameters,
        }
    }

    fn value_interval(
        &self,
        metric: Metric,
        family: usize,
        estimator: &str,
        runs: &FamilyRuns<'_>,
    ) -> Option<Interval> {
        let sizes: Vec<usize> = runs.iter().map(Vec::len).collect();
        if metric.is_logarithmic() && sizes.iter().sum::<usize>() < VOLUME_RUNS * self.parameters() {
            return None;
        }
        let seed = self.seed.child(&format!("value {estimator} {metric:?}"), family as u64);
        bootstrap_interval(&[&sizes], metric.resamples(), LEVEL, seed, |drawn| {
            let picked: Vec<Run<'_>> = drawn[0].iter().map(|&(design, run)| runs[design][run]).collect();
            self.value(metric, &picked)
        })
    }

    fn parameter_scores(&self, family: usize, runs: &FamilyRuns<'_>) -> Vec<ParameterScore> {
        let bounds: Vec<&[f64]> =
            self.designs.iter().filter(|design| design.family == family).map(|design| design.bound_std).collect();
        (0..self.parameters())
            .map(|i| {
                let errors: Vec<Vec<f64>> =
                    runs.iter().map(|design| design.iter().map(|run| run.error(i)).collect()).collect();
                let pooled: Vec<f64> = errors.iter().flatten().copied().collect();
                let stated: Vec<f64> = runs.iter().flatten().map(|run| run.estimate.std[i]).collect();
                let hits = runs.iter().flatten().filter(|run| run.error(i).abs() <= run.estimate.half_width[i]).count();
                let means: Vec<f64> = errors.iter().filter(|e| !e.is_empty()).map(|e| mean(e)).collect();
                let units = if means.len() > 1 { &means } else { &pooled };
                let variances: Vec<f64> = errors.iter().filter(|e| e.len() > 1).map(|e| variance(e)).collect();
                ParameterScore {
                    bias: mean(&pooled),
                    bias_interval: t_interval(units, LEVEL),
                    std: mean(&variances).sqrt(),
                    stated_std: mean(&stated),
                    bound_std: mean(&bounds.iter().map(|b| b[i] * b[i]).collect::<Vec<_>>()).sqrt(),
                    rmse: root_mean_square(&pooled),
                    coverage: hits as f64 / pooled.len().max(1) as f64,
                    coverage_interval: wilson_interval(hits, pooled.len(), LEVEL),
                    spread: Spread::of(&pooled),
                }
            })
            .collect()
    }
}
