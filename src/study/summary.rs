//! From the outcomes of all runs to what a study says: per design, per family of designs, per parameter, and the
//! differences between families with their intervals.
//!
//! ```text
//! family value     geometric mean over its runs of the RMSE          (no single bad design decides)
//! difference       ratio of two family values, 95 % interval by bootstrap over designs and runs
//! log volume       ½ ln det( mean over all runs of z zᵀ ),  z_i = e_i / u_i
//! bias             mean error; its interval takes designs as the units where there are at least two
//! ```
//! Metrics stand in the order in which they decide: torque prediction first.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::outcome::{Outcome, ScoredEstimate};
use super::statistics::{
    Interval, Spread, bootstrap_interval, mean, quantile, rank_correlation, t_interval, variance, wilson_interval,
};
use crate::seed::Seed;

/// Draws of every bootstrap.
const RESAMPLES: usize = 1000;
/// Draws where the statistic is a determinant, which costs a thousand times more.
const VOLUME_RESAMPLES: usize = 200;
/// Runs for each parameter from which on a volume has an interval.
const VOLUME_RUNS: usize = 4;
/// Confidence of every interval.
const LEVEL: f64 = 0.95;

/// By what designs are compared, in the order in which it decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Torque prediction RMSE on validation trajectories, N·m.
    Prediction,
    /// The same, each joint over its torque rating.
    PredictionOfRating,
    /// Log volume of the error in reference units.
    LogVolume,
    /// RMS parameter error in reference units.
    Reference,
}

impl Metric {
    /// Every metric, the first deciding.
    pub const ALL: [Self; 4] = [Self::Prediction, Self::PredictionOfRating, Self::LogVolume, Self::Reference];

    /// Name in tables.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Prediction => "torque prediction RMSE, N·m",
            Self::PredictionOfRating => "torque prediction RMSE, share of the rating",
            Self::LogVolume => "log volume of the error, reference units",
            Self::Reference => "parameter RMSE, reference units",
        }
    }

    /// Whether two values are compared by their difference rather than their ratio.
    #[must_use]
    pub const fn is_logarithmic(self) -> bool {
        matches!(self, Self::LogVolume)
    }

    fn of(self, estimate: &ScoredEstimate) -> Option<f64> {
        let score = estimate.score.as_ref()?;
        match self {
            Self::Prediction => Some(score.prediction_rmse_nm),
            Self::PredictionOfRating => Some(score.prediction_rmse_of_rating),
            Self::Reference => Some(score.reference_rmse),
            Self::LogVolume => None,
        }
    }
}

/// What a family of designs achieved with one estimator.
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

/// What a family achieved on one base parameter.
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

/// Two families by one metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// By what.
    pub metric: Metric,
    /// With which estimator.
    pub estimator: String,
    /// The first family.
    pub first: String,
    /// The second family.
    pub second: String,
    /// First over second; for a logarithmic metric first minus second. Below 1 (0): the first is better.
    pub difference: f64,
    /// Its 95 % interval.
    pub interval: Option<Interval>,
    /// The better family, where the interval excludes no difference.
    pub better: Option<String>,
}

/// Whether a design's own criterion value tells the error that it achieves.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Foretelling {
    /// Which value of the design.
    pub value: String,
    /// With which estimator.
    pub estimator: String,
    /// Spearman's rank correlation over designs with the median prediction error.
    pub rank_correlation: Option<f64>,
    /// Number of designs.
    pub designs: usize,
}

/// One design, as the summary needs it.
#[derive(Clone, Copy, Debug)]
pub struct DesignRow<'a> {
    /// Index of its family.
    pub family: usize,
    /// Cramér–Rao standard deviations (b).
    pub bound_std: &'a [f64],
    /// Values that might foretell its error, by name.
    pub values: &'a [(&'a str, f64)],
}

/// Everything that is summed up.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Names of the families.
    pub families: &'a [String],
    /// The designs of the study.
    pub designs: &'a [DesignRow<'a>],
    /// Names of the estimators.
    pub estimators: &'a [String],
    /// True base parameters (b).
    pub truth: &'a DVector<f64>,
    /// Reference units (b).
    pub units: &'a DVector<f64>,
    /// All outcomes, sorted by design and run.
    pub outcomes: &'a [Outcome],
    /// Families that every other is compared with; all pairs where there are none.
    pub compare_with: &'a [String],
    /// Seed of the bootstraps.
    pub seed: Seed,
}

/// What all outcomes together say.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Findings {
    /// Every family with every estimator.
    pub families: Vec<FamilyScore>,
    /// Every pair of families, by every metric, with every estimator.
    pub comparisons: Vec<Comparison>,
    /// Median over runs of the prediction RMSE of each design (outer: estimator, inner: design), N·m.
    pub design_prediction: Vec<Vec<Option<Spread>>>,
    /// Whether criterion values tell the error.
    pub foretelling: Vec<Foretelling>,
}

/// The runs of one family with one estimator: design → run → estimate.
type FamilyRuns<'a> = Vec<Vec<&'a ScoredEstimate>>;

impl Evidence<'_> {
    /// Sums up.
    #[must_use]
    pub fn findings(&self) -> Findings {
        let mut findings = Findings {
            families: Vec::new(),
            comparisons: Vec::new(),
            design_prediction: Vec::new(),
            foretelling: Vec::new(),
        };
        for (e, estimator) in self.estimators.iter().enumerate() {
            let runs: Vec<FamilyRuns<'_>> = (0..self.families.len()).map(|family| self.runs(family, e)).collect();
            for (family, runs) in runs.iter().enumerate() {
                findings.families.push(self.family_score(family, estimator, runs));
            }
            for first in 0..runs.len() {
                for second in first + 1..runs.len() {
                    let named = |family: usize| self.compare_with.contains(&self.families[family]);
                    if !(self.compare_with.is_empty() || named(first) || named(second)) {
                        continue;
                    }
                    for metric in Metric::ALL {
                        findings.comparisons.extend(self.compare(metric, estimator, [first, second], &runs));
                    }
                }
            }
            let spread = self.design_spread(e);
            findings.foretelling.extend(self.foretelling(estimator, &spread));
            findings.design_prediction.push(spread);
        }
        findings
    }

    fn runs(&self, family: usize, estimator: usize) -> FamilyRuns<'_> {
        self.designs
            .iter()
            .enumerate()
            .filter(|(_, design)| design.family == family)
            .map(|(index, _)| {
                self.outcomes
                    .iter()
                    .filter(|outcome| outcome.design == index)
                    .filter_map(|outcome| outcome.estimates.get(estimator))
                    .filter(|estimate| estimate.score.is_some())
                    .collect()
            })
            .collect()
    }

    fn error(&self, estimate: &ScoredEstimate) -> DVector<f64> {
        DVector::from_column_slice(&estimate.beta) - self.truth
    }

    fn family_score(&self, family: usize, estimator: &str, runs: &FamilyRuns<'_>) -> FamilyScore {
        let all: Vec<&ScoredEstimate> = runs.iter().flatten().copied().collect();
        let of = |metric: Metric| all.iter().filter_map(|estimate| metric.of(estimate)).collect::<Vec<_>>();
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

    fn parameter_scores(&self, family: usize, runs: &FamilyRuns<'_>) -> Vec<ParameterScore> {
        let bounds: Vec<&[f64]> =
            self.designs.iter().filter(|design| design.family == family).map(|design| design.bound_std).collect();
        (0..self.truth.len())
            .map(|i| {
                let errors: Vec<Vec<f64>> =
                    runs.iter().map(|design| design.iter().map(|e| e.beta[i] - self.truth[i]).collect()).collect();
                let pooled: Vec<f64> = errors.iter().flatten().copied().collect();
                let stated: Vec<f64> = runs.iter().flatten().map(|e| e.std[i]).collect();
                let hits =
                    runs.iter().flatten().filter(|e| (e.beta[i] - self.truth[i]).abs() <= e.half_width[i]).count();
                let means: Vec<f64> = errors.iter().filter(|e| !e.is_empty()).map(|e| mean(e)).collect();
                let units = if means.len() > 1 { &means } else { &pooled };
                let variances: Vec<f64> = errors.iter().filter(|e| e.len() > 1).map(|e| variance(e)).collect();
                ParameterScore {
                    bias: mean(&pooled),
                    bias_interval: t_interval(units, LEVEL),
                    std: mean(&variances).sqrt(),
                    stated_std: mean(&stated),
                    bound_std: mean(&bounds.iter().map(|b| b[i] * b[i]).collect::<Vec<_>>()).sqrt(),
                    rmse: super::statistics::root_mean_square(&pooled),
                    coverage: hits as f64 / pooled.len().max(1) as f64,
                    coverage_interval: wilson_interval(hits, pooled.len(), LEVEL),
                    spread: Spread::of(&pooled),
                }
            })
            .collect()
    }

    fn value(&self, metric: Metric, runs: &[&ScoredEstimate]) -> Option<f64> {
        if runs.is_empty() {
            return None;
        }
        if metric == Metric::LogVolume {
            return self.log_volume(runs.iter().copied());
        }
        let logs: Vec<f64> = runs.iter().filter_map(|e| metric.of(e)).map(libm::log).collect();
        Some(libm::exp(mean(&logs)))
    }

    fn value_interval(
        &self,
        metric: Metric,
        family: usize,
        estimator: &str,
        runs: &FamilyRuns<'_>,
    ) -> Option<Interval> {
        let sizes: Vec<usize> = runs.iter().map(Vec::len).collect();
        if metric.is_logarithmic() && sizes.iter().sum::<usize>() < VOLUME_RUNS * self.truth.len() {
            return None;
        }
        let resamples = if metric.is_logarithmic() { VOLUME_RESAMPLES } else { RESAMPLES };
        let seed = self.seed.child(&format!("value {estimator} {metric:?}"), family as u64);
        bootstrap_interval(&[&sizes], resamples, LEVEL, seed, |drawn| {
            let picked: Vec<&ScoredEstimate> = drawn[0].iter().map(|&(design, run)| runs[design][run]).collect();
            self.value(metric, &picked)
        })
    }

    fn log_volume<'e>(&self, runs: impl Iterator<Item = &'e ScoredEstimate>) -> Option<f64> {
        let columns: Vec<DVector<f64>> = runs.map(|e| self.error(e).component_div(self.units)).collect();
        if columns.len() <= self.truth.len() {
            return None;
        }
        let z = DMatrix::from_columns(&columns);
        let moment = &z * z.transpose() / columns.len() as f64;
        Some(Cholesky::new(moment)?.l_dirty().diagonal().iter().map(|&d| libm::log(d)).sum())
    }

    fn compare(
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
        let resamples = if metric.is_logarithmic() { VOLUME_RESAMPLES } else { RESAMPLES };
        let seed =
            self.seed.child(&format!("{estimator} {metric:?}"), (pair[0] * self.families.len() + pair[1]) as u64);
        let interval = bootstrap_interval(&[&sizes[0], &sizes[1]], resamples, LEVEL, seed, |drawn| {
            let value = |side: usize| {
                let picked: Vec<&ScoredEstimate> =
                    drawn[side].iter().map(|&(design, run)| runs[pair[side]][design][run]).collect();
                self.value(metric, &picked)
            };
            Some(difference(value(0)?, value(1)?))
        });
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

    fn design_spread(&self, estimator: usize) -> Vec<Option<Spread>> {
        (0..self.designs.len())
            .map(|index| {
                let values: Vec<f64> = self
                    .outcomes
                    .iter()
                    .filter(|outcome| outcome.design == index)
                    .filter_map(|outcome| Metric::Prediction.of(outcome.estimates.get(estimator)?))
                    .collect();
                Spread::of(&values)
            })
            .collect()
    }

    fn foretelling(&self, estimator: &str, spread: &[Option<Spread>]) -> Vec<Foretelling> {
        let Some(first) = self.designs.first() else { return Vec::new() };
        (0..first.values.len())
            .map(|v| {
                let (x, y): (Vec<f64>, Vec<f64>) = self
                    .designs
                    .iter()
                    .zip(spread)
                    .filter_map(|(design, spread)| Some((design.values[v].1, spread.as_ref()?.median)))
                    .unzip();
                Foretelling {
                    value: first.values[v].0.to_owned(),
                    estimator: estimator.to_owned(),
                    rank_correlation: rank_correlation(&x, &y),
                    designs: x.len(),
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Failure, FailureKind, Score};
    use rand_distr::{Distribution, StandardNormal};

    /// Two families of 6 designs × 20 runs, b = 3, white errors of standard deviation 1 and 2, honest intervals.
    fn findings() -> Findings {
        let truth = DVector::from_vec(vec![1.0, -2.0, 0.0]);
        let units = DVector::from_element(3, 1.0);
        let families = ["narrow".to_owned(), "wide".to_owned()];
        let bounds = [[1.0; 3], [2.0; 3]];
        let values: Vec<[(&str, f64); 1]> = (0..12).map(|d| [("scale", bounds[d / 6][0])]).collect();
        let designs: Vec<DesignRow<'_>> =
            (0..12).map(|d| DesignRow { family: d / 6, bound_std: &bounds[d / 6], values: &values[d] }).collect();
        let mut rng = Seed::new(3).stream("errors", 0);
        let mut outcomes = Vec::new();
        for design in 0..12 {
            for run in 0..20 {
                let sigma = bounds[design / 6][0];
                let error: Vec<f64> = (0..3)
                    .map(|_| {
                        sigma * {
                            let z: f64 = StandardNormal.sample(&mut rng);
                            z
                        }
                    })
                    .collect();
                let rmse = super::super::statistics::root_mean_square(&error);
                outcomes.push(Outcome {
                    design,
                    condition: 0,
                    run,
                    failure: None,
                    estimates: vec![ScoredEstimate {
                        estimator: "ols".to_owned(),
                        failure: None,
                        beta: error.iter().zip(truth.iter()).map(|(e, t)| e + t).collect(),
                        std: vec![sigma; 3],
                        half_width: vec![1.96 * sigma; 3],
                        residual_rms: vec![sigma],
                        score: Some(Score {
                            prediction_rmse_nm: rmse,
                            prediction_rmse_of_rating: rmse,
                            joint_rmse_nm: vec![rmse],
                            reference_rmse: rmse,
                        }),
                    }],
                });
            }
        }
        let failure = Some(Failure { kind: FailureKind::DivergedSpeed, reason: "too fast".to_owned() });
        outcomes.push(Outcome { design: 11, condition: 0, run: 20, failure, estimates: Vec::new() });
        let estimators = ["ols".to_owned()];
        Evidence {
            families: &families,
            designs: &designs,
            estimators: &estimators,
            truth: &truth,
            units: &units,
            outcomes: &outcomes,
            compare_with: &[],
            seed: Seed::new(1),
        }
        .findings()
    }

    #[test]
    fn statistics_recover_a_known_ratio_and_a_known_volume() {
        let findings = findings();
        let of = |metric| findings.comparisons.iter().find(|c| c.metric == metric).unwrap();
        let prediction = of(Metric::Prediction);
        assert!(prediction.interval.unwrap().contains(0.5), "{prediction:?}");
        assert_eq!(prediction.better.as_deref(), Some("narrow"));
        // ½ ln det of σ² 1 is 3 ln σ: the difference of the two is −3 ln 2, to a sampling error of about 0.16.
        let volume = of(Metric::LogVolume);
        assert!((volume.difference + 3.0 * 2.0_f64.ln()).abs() < 0.5, "{volume:?}");
    }

    #[test]
    fn statistics_count_failures_and_cover_with_honest_intervals() {
        let findings = findings();
        let wide = &findings.families[1];
        assert_eq!((wide.runs, wide.failures, wide.designs), (120, 1, 6));
        // 360 independent intervals at 95 %: 92 to 98 % but for a chance of 1 %.
        assert!((0.92..=0.98).contains(&wide.coverage), "{}", wide.coverage);
        for parameter in &wide.parameters {
            assert!((parameter.std - 2.0).abs() < 0.6 && (parameter.bound_std - 2.0).abs() < 1e-12);
        }
        assert!(findings.foretelling[0].rank_correlation.unwrap() > 0.7);
    }
}
