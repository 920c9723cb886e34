//! The score of a family of designs, in all and parameter by parameter.

use super::error::StudyError;
use super::estimator_runs::EstimatorRuns;
use super::evidence::{Evidence, LEVEL, RunValues, present};
use super::metric::Metric;
use super::run_table::RunNumber;
use crate::seed::Seed;
use crate::statistics::{Interval, Spread, mean, quantile, root_mean_square, share_interval, t_interval, variance};

/// Runs for each parameter from which on a volume has an interval.
pub(super) const VOLUME_RUNS: usize = 4;

/// Draws of the bootstrap of a log volume.
pub(super) const VOLUME_RESAMPLES: usize = 200;

/// The score of a family of designs with one estimator.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// One value per metric, in the order of [`Metric::ALL`]: the geometric mean over designs of that over the runs of each; `None`
    /// where it is not defined (a volume needs more runs than parameters).
    pub values: Vec<Option<f64>>,
    /// Their 95 % intervals: by Student's t of the logarithms over designs, over runs of an only design. That of a volume is by
    /// bootstrap over designs and runs, and `None` where there are fewer than four runs for each parameter, since draws with
    /// repetition would make it singular.
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
    /// The geometric mean over designs in one metric (of a log volume the value); `None` where it is not defined.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        self.values.get(place_of(metric)).copied().flatten()
    }

    /// Its 95 % interval.
    pub fn interval(&self, metric: Metric) -> Option<Interval> {
        self.intervals.get(place_of(metric)).copied().flatten()
    }

    /// The bound of one experiment where `experiments` make up the whole, `bound √k`: as long as it falls, an experiment
    /// gains more than the same number of samples of those before it; where it stands still, the design has nothing left
    /// to add.
    pub fn bound_per_experiment(&self, experiments: usize) -> Option<f64> {
        self.bound_in_units.map(|bound| bound * libm::sqrt(experiments as f64))
    }
}

/// The score of a family on one base parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ParameterScore {
    /// Mean error over designs, over runs of an only design, in the parameter's unit.
    pub bias: f64,
    /// Its 95 % interval.
    pub bias_interval: Option<Interval>,
    /// Standard deviation over the runs of a design, root of the mean variance over designs; `None` of one run each.
    pub std: Option<f64>,
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
    /// The score of a family but for its metrics.
    pub(super) fn family_score(&self, family: usize, runs: &EstimatorRuns<'_>) -> Result<FamilyScore, StudyError> {
        let designs = self.designs_of(family);
        let planned: usize = designs.iter().map(|&design| self.runs.runs(design, self.condition)).sum();
        let scored: usize = designs.iter().map(|&design| runs.count(design)).sum();
        let parameters = (0..self.parameters())
            .map(|parameter| self.parameter_score(parameter, &designs, runs))
            .collect::<Result<Vec<_>, _>>()?;
        let over_bound: Vec<f64> =
            parameters.iter().filter_map(|p| Some(p.std? / p.bound_std)).filter(|r| r.is_finite()).collect();
        let in_units: Vec<f64> = parameters.iter().zip(self.units.iter()).map(|(p, unit)| p.bound_std / unit).collect();
        Ok(FamilyScore {
            family: self.families[family].clone(),
            estimator: runs.name.to_owned(),
            designs: designs.len(),
            runs: scored,
            failures: planned - scored,
            values: vec![None; Metric::ALL.len()],
            intervals: vec![None; Metric::ALL.len()],
            std_over_bound: quantile(&over_bound, 0.5),
            bound_in_units: quantile(&in_units, 0.5).filter(|value| value.is_finite()),
            coverage: mean(&parameters.iter().map(|p| p.coverage).collect::<Vec<_>>()),
            parameters,
            ..FamilyScore::default()
        })
    }

    /// Adds the spread over runs of a metric to the scores of all families.
    pub(super) fn add_spread(&self, metric: Metric, values: &RunValues, scores: &mut [FamilyScore]) {
        for (family, score) in scores.iter_mut().enumerate() {
            let spread = match metric {
                Metric::Prediction => &mut score.prediction_spread,
                Metric::Reference => &mut score.reference_spread,
                _ => return,
            };
            let values = self.designs_of(family).into_iter().flat_map(|design| present(&values[design]));
            *spread = Spread::new(&values.collect::<Vec<f64>>());
        }
    }

    /// Adds one metric of single runs, by its logarithms, to the scores of all families.
    pub(super) fn add_metric(
        &self,
        metric: Metric,
        runs: &EstimatorRuns<'_>,
        logs: &RunValues,
        scores: &mut [FamilyScore],
    ) {
        let place = place_of(metric);
        for (family, score) in scores.iter_mut().enumerate() {
            let units = self.units_of(family, runs, logs).values();
            score.values[place] = (!units.is_empty()).then(|| libm::exp(mean(&units)));
            score.intervals[place] =
                t_interval(&units, LEVEL).filter(|of| of.low.is_finite()).map(Interval::exponentiated);
        }
    }

    /// Adds the log volume of the errors to the scores of all families.
    pub(super) fn add_volumes(&self, runs: &EstimatorRuns<'_>, scores: &mut [FamilyScore]) -> Result<(), StudyError> {
        let (metric, volumes) = (Metric::LogVolume, self.volumes(runs));
        let place = place_of(metric);
        for (family, score) in scores.iter_mut().enumerate() {
            let designs = self.designs_of(family);
            score.values[place] = volumes.value(&designs)?;
            let sizes: Vec<usize> = designs.iter().map(|&design| runs.size(design)).collect();
            if sizes.iter().sum::<usize>() >= VOLUME_RUNS * self.parameters() {
                let seed = self.value_seed(metric, family, runs);
                let sides = [(&designs[..], &sizes[..])];
                let value = score.values[place];
                let drawn = volumes.interval(runs, &sides, VOLUME_RESAMPLES, LEVEL, seed, |values| values[0])?;
                // Draws with repetition shrink a determinant: an interval beside its own estimate says nothing.
                score.intervals[place] = drawn.filter(|drawn| value.is_some_and(|value| drawn.contains(value)));
            }
        }
        Ok(())
    }

    fn value_seed(&self, metric: Metric, family: usize, runs: &EstimatorRuns<'_>) -> Seed {
        self.seed.child(&format!("value {} {metric:?}", runs.name), family as u64)
    }

    fn parameter_score(
        &self,
        parameter: usize,
        designs: &[usize],
        runs: &EstimatorRuns<'_>,
    ) -> Result<ParameterScore, StudyError> {
        let estimator = runs.index;
        let read = |number: RunNumber| {
            designs
                .iter()
                .map(|&design| Ok(present(&self.scored_numbers(runs, design, number)?)))
                .collect::<Result<Vec<Vec<f64>>, StudyError>>()
        };
        let errors = read(RunNumber::Error { estimator, parameter })?;
        let hits = {
            let half_widths = read(RunNumber::HalfWidth { estimator, parameter })?;
            let pairs = errors.iter().flatten().zip(half_widths.iter().flatten());
            pairs.filter(|(error, half_width)| error.abs() <= **half_width).count()
        };
        let stated_std = mean(&read(RunNumber::Std { estimator, parameter })?.concat());
        let bounds: Vec<f64> =
            designs.iter().map(|&design| self.designs[design].bound_std[parameter].powi(2)).collect();
        let pooled: Vec<f64> = errors.iter().flatten().copied().collect();
        let means: Vec<f64> = errors.iter().filter(|e| !e.is_empty()).map(|e| mean(e)).collect();
        // Means over runs that share noise are independent of each other, the runs are not.
        let of_groups: Vec<Vec<f64>> =
            designs.iter().zip(&errors).map(|(&design, errors)| runs.group_means(design, errors)).collect();
        let units = if means.len() > 1 { means } else { of_groups.concat() };
        let groups: usize = of_groups.iter().map(Vec::len).sum();
        let coverage = hits as f64 / pooled.len().max(1) as f64;
        let variances =
            designs.iter().zip(&errors).filter_map(|(&design, errors)| self.error_variance(runs, design, errors));
        let variances: Vec<f64> = variances.collect();
        Ok(ParameterScore {
            bias: mean(&units),
            bias_interval: t_interval(&units, LEVEL),
            std: (!variances.is_empty()).then(|| mean(&variances).sqrt()),
            stated_std,
            bound_std: mean(&bounds).sqrt(),
            rmse: root_mean_square(&pooled),
            coverage,
            // Runs that share noise count as one.
            coverage_interval: share_interval(coverage, groups, LEVEL),
            spread: Spread::new(&pooled),
        })
    }
}

impl Evidence<'_> {
    /// Variance of a design's errors over runs of independent noise: of the first of each group that shares it, and so on for the
    /// others, in the mean. `None` of fewer than two groups.
    fn error_variance(&self, runs: &EstimatorRuns<'_>, design: usize, errors: &[f64]) -> Option<f64> {
        let of_place = |place: usize| {
            let of_groups = (0..runs.size(design)).filter_map(|index| runs.group(design, index).nth(place));
            of_groups.map(|run| errors[run]).collect::<Vec<f64>>()
        };
        let variances: Vec<f64> =
            (0..self.runs_of_noise).map(of_place).filter(|of| of.len() > 1).map(|of| variance(&of)).collect();
        (!variances.is_empty()).then(|| mean(&variances))
    }
}

/// Where a metric stands in the lists of a score.
fn place_of(metric: Metric) -> usize {
    Metric::ALL.iter().position(|&other| other == metric).unwrap_or_default()
}
