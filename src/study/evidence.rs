//! From the outcomes of all runs to the findings of a study: per design, per family of designs, per parameter, and the
//! differences between families with their intervals.
//!
//! ```text
//! design value     mean over its runs of the logarithm of the RMSE
//! family value     exp of the mean over its designs, t interval over designs      (no single bad design decides)
//! difference       ratio of two families: t interval over designs that share their start, else Welch's (see `comparison`)
//! log volume       ½ ln det( mean over all runs of z zᵀ ),  z_i = e_i / u_i
//! bias             mean error; its interval takes designs as the units where there are at least two
//! foretelling      Spearman's rank correlation over designs of each criterion value with the median of each metric
//! ```
//! Metrics stand in the order in which they decide: torque prediction first.

use nalgebra::DVector;

use super::comparison::Comparison;
use super::criterion_correlation::CriterionCorrelation;
use super::error::StudyError;
use super::estimator_comparison::EstimatorComparison;
use super::estimator_runs::EstimatorRuns;
use super::family_score::FamilyScore;
use super::metric::Metric;
use super::run_table::{RunNumber, RunTable};
use super::shared_start::SharedStart;
use super::truth_comparison::TruthComparison;
use crate::seed::Seed;
use crate::statistics::Spread;

/// Confidence of every interval.
pub(super) const LEVEL: f64 = 0.95;

/// One design with the values that its runs are compared with.
#[derive(Clone, Copy, Debug)]
pub struct DesignRow<'a> {
    /// Index of its family.
    pub family: usize,
    /// Where its search began.
    pub start: SharedStart,
    /// Cramér–Rao standard deviations (b).
    pub bound_std: &'a [f64],
    /// Values that may predict its error, by name.
    pub values: &'a [(&'a str, f64)],
}

/// The input of the findings: designs, truths and the numbers of all runs.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Names of the families.
    pub families: &'a [String],
    /// Families that every other is compared with; empty compares all pairs.
    pub compare_with: &'a [String],
    /// The designs of the study.
    pub designs: &'a [DesignRow<'a>],
    /// Names of the estimators.
    pub estimators: &'a [String],
    /// Number of truths that were drawn; they are counted from one.
    pub truths: usize,
    /// Reference units (b).
    pub units: &'a DVector<f64>,
    /// The numbers of all runs.
    pub runs: &'a dyn RunTable,
    /// Index of the condition that the findings are about.
    pub condition: usize,
    /// So many runs in succession share their noise: no fewer are independent of others.
    pub runs_of_noise: usize,
    /// Whether runs of the same number of two designs share arm or noise.
    pub runs_are_matched: bool,
    /// Whether signs and phases of effects are drawn with each truth: the truths are then units as designs are.
    pub draws_effects: bool,
    /// Seed of the draws of log volumes.
    pub seed: Seed,
}

/// Scores, comparisons and correlations over all outcomes.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Findings {
    /// The score of every family with every estimator.
    pub families: Vec<FamilyScore>,
    /// The comparison of every pair of families, in every metric, with every estimator.
    pub comparisons: Vec<Comparison>,
    /// Every estimator against the one that figures show, on the same recordings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub estimator_comparisons: Vec<EstimatorComparison>,
    /// Estimators compared over random truths, if the study draws them.
    #[serde(default)]
    pub over_truths: Vec<TruthComparison>,
    /// Median over runs of the prediction RMSE of each design (outer: estimator, inner: design), N·m.
    pub design_prediction: Vec<Vec<Option<Spread>>>,
    /// How well criterion values predict the error, by each metric of single runs.
    #[serde(rename = "foretelling")]
    pub criterion_correlations: Vec<CriterionCorrelation>,
}

/// One number of the runs that gave an estimate: design → run. Metrics that an arm was not asked for are `None`.
pub(super) type RunValues = Vec<Vec<Option<f64>>>;

impl Evidence<'_> {
    /// Computes the findings.
    ///
    /// # Errors
    /// [`StudyError::Runs`] where the numbers of the runs cannot be read.
    pub fn findings(&self) -> Result<Findings, StudyError> {
        let mut findings = Findings { estimator_comparisons: self.estimator_comparisons()?, ..Findings::default() };
        let pairs = self.pairs();
        for (index, name) in self.estimators.iter().enumerate() {
            let runs = self.estimator_runs(index, name)?;
            let mut scores = (0..self.families.len())
                .map(|family| self.family_score(family, &runs))
                .collect::<Result<Vec<_>, _>>()?;
            // Metric by metric, so that the values of one alone are held; told pair by pair.
            let mut comparisons: Vec<Vec<Comparison>> = vec![Vec::new(); pairs.len()];
            let mut over_truths: Vec<Vec<TruthComparison>> = vec![Vec::new(); pairs.len()];
            for metric in Metric::ALL {
                if metric.is_logarithmic() {
                    self.add_volumes(&runs, &mut scores)?;
                    for (&pair, found) in pairs.iter().zip(&mut comparisons) {
                        found.extend(self.compare_volumes(&runs, pair)?);
                    }
                    continue;
                }
                let values = self.metric_values(&runs, metric)?;
                let spread: Vec<Option<Spread>> = values.iter().map(|of| Spread::new(&present(of))).collect();
                findings.criterion_correlations.extend(self.criterion_correlations(name, metric, &spread));
                if metric == Metric::Prediction {
                    findings.design_prediction.push(spread);
                }
                self.add_spread(metric, &values, &mut scores);
                let logs = logarithms(values);
                self.add_metric(metric, &runs, &logs, &mut scores);
                let compared = self.compare(metric, &runs, &pairs, &logs);
                for (found, compared) in comparisons.iter_mut().zip(compared) {
                    found.extend(compared);
                }
                for (&pair, over) in pairs.iter().zip(&mut over_truths) {
                    over.extend(self.over_truths(metric, &runs, pair, &logs));
                }
            }
            findings.families.extend(scores);
            findings.comparisons.extend(comparisons.into_iter().flatten());
            findings.over_truths.extend(over_truths.into_iter().flatten());
        }
        Ok(findings)
    }

    /// Every pair of families that is compared.
    fn pairs(&self) -> Vec<[usize; 2]> {
        let named = |family: usize| self.compare_with.contains(&self.families[family]);
        let all = (0..self.families.len())
            .flat_map(|first| (first + 1..self.families.len()).map(move |second| [first, second]));
        all.filter(|pair| self.compare_with.is_empty() || pair.iter().any(|&family| named(family))).collect()
    }

    /// Indices of the designs of a family.
    pub(super) fn designs_of(&self, family: usize) -> Vec<usize> {
        (0..self.designs.len()).filter(|&design| self.designs[design].family == family).collect()
    }

    /// One number of all runs of a design.
    pub(super) fn numbers(&self, design: usize, number: RunNumber) -> Result<Vec<Option<f64>>, StudyError> {
        self.runs.numbers(design, self.condition, 0..self.runs.runs(design, self.condition), number)
    }

    /// The runs that gave an estimate with one estimator.
    fn estimator_runs<'a>(&self, estimator: usize, name: &'a str) -> Result<EstimatorRuns<'a>, StudyError> {
        let (mut scored, mut truths) = (Vec::new(), Vec::new());
        for design in 0..self.designs.len() {
            let predictions = self.numbers(design, RunNumber::Metric { estimator, metric: Metric::Prediction })?;
            let of_design: Vec<bool> = predictions.iter().map(Option::is_some).collect();
            let all = self.numbers(design, RunNumber::Truth)?;
            let with = all.iter().zip(&of_design).filter(|(_, scored)| **scored);
            truths.push(with.map(|(truth, _)| truth.unwrap_or_default() as usize).collect());
            scored.push(of_design);
        }
        Ok(EstimatorRuns::new(estimator, name, scored, truths, self.runs_of_noise))
    }

    /// One number of the runs of a design that gave an estimate.
    pub(super) fn scored_numbers(
        &self,
        runs: &EstimatorRuns<'_>,
        design: usize,
        number: RunNumber,
    ) -> Result<Vec<Option<f64>>, StudyError> {
        let all = self.numbers(design, number)?;
        Ok(all.into_iter().zip(runs.scored(design)).filter(|(_, scored)| **scored).map(|(value, _)| value).collect())
    }

    fn metric_values(&self, runs: &EstimatorRuns<'_>, metric: Metric) -> Result<RunValues, StudyError> {
        let number = RunNumber::Metric { estimator: runs.index, metric };
        (0..self.designs.len()).map(|design| self.scored_numbers(runs, design, number)).collect()
    }

    /// Number of base parameters b.
    pub(super) fn parameters(&self) -> usize {
        self.units.len()
    }
}

/// The values that are there.
pub(super) fn present(values: &[Option<f64>]) -> Vec<f64> {
    values.iter().copied().flatten().collect()
}

/// The logarithms of values.
pub(super) fn logarithms(mut values: RunValues) -> RunValues {
    for value in values.iter_mut().flatten().flatten() {
        *value = libm::log(*value);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::small_results::erring;
    use crate::study::{Outcome, OutcomeTable, RunError, RunErrorKind, ScoredEstimate};
    use rand_distr::{Distribution, StandardNormal};

    /// Two families of 6 designs × 20 runs, b = 3, white errors of standard deviation 1 and 2, honest intervals.
    fn findings() -> Findings {
        let truths = [DVector::from_vec(vec![1.0, -2.0, 0.0])];
        let units = DVector::from_element(3, 4.0);
        let families = ["narrow".to_owned(), "wide".to_owned()];
        let bounds = [[1.0; 3], [2.0; 3]];
        let values: Vec<[(&str, f64); 1]> = (0..12).map(|d| [("scale", bounds[d / 6][0])]).collect();
        let designs: Vec<DesignRow<'_>> = (0..12)
            .map(|d| DesignRow {
                family: d / 6,
                start: SharedStart::Guess(d % 6),
                bound_std: &bounds[d / 6],
                values: &values[d],
            })
            .collect();
        let mut rng = Seed::new(3).stream("errors", 0);
        let mut outcomes = Vec::new();
        for design in 0..12 {
            for run in 0..20 {
                let sigma = bounds[design / 6][0];
                let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
                let error: Vec<f64> = (0..3).map(|_| sigma * normal()).collect();
                let rmse = crate::statistics::root_mean_square(&error);
                outcomes.push(Outcome {
                    design,
                    condition: 0,
                    truth: 0,
                    run,
                    failure: None,
                    estimates: vec![ScoredEstimate {
                        estimator: "ols".to_owned(),
                        failure: None,
                        beta: error.iter().zip(truths[0].iter()).map(|(e, t)| e + t).collect(),
                        std: vec![sigma; 3],
                        half_width: vec![1.96 * sigma; 3],
                        residual_rms: vec![sigma],
                        score: Some(erring(rmse)),
                    }],
                });
            }
        }
        let failure = Some(RunError { kind: RunErrorKind::DivergedSpeed, reason: "too fast".to_owned() });
        outcomes.push(Outcome { design: 11, condition: 0, truth: 0, run: 20, failure, estimates: Vec::new() });
        let estimators = ["ols".to_owned()];
        Evidence {
            families: &families,
            compare_with: &[],
            designs: &designs,
            estimators: &estimators,
            truths: truths.len() - 1,
            units: &units,
            runs: &OutcomeTable { outcomes: &outcomes, truths: &truths },
            condition: 0,
            runs_of_noise: 1,
            runs_are_matched: false,
            draws_effects: false,
            seed: Seed::new(1),
        }
        .findings()
        .unwrap()
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
        let interval = volume.interval.unwrap();
        assert!(interval.contains(volume.difference) && interval.high - interval.low < 1.5, "{volume:?}");
    }

    #[test]
    fn statistics_count_failures_and_cover_with_honest_intervals() {
        let findings = findings();
        let wide = &findings.families[1];
        assert_eq!((wide.runs, wide.failures, wide.designs), (120, 1, 6));
        // The bound, 2, in units of 4.
        assert_eq!(wide.bound_in_units, Some(0.5));
        // 360 independent intervals at 95 %: 92 to 98 % but for a chance of 1 %.
        assert!((0.92..=0.98).contains(&wide.coverage), "{}", wide.coverage);
        for parameter in &wide.parameters {
            assert!((parameter.std.unwrap() - 2.0).abs() < 0.6 && (parameter.bound_std - 2.0).abs() < 1e-12);
        }
        assert!(findings.criterion_correlations[0].rank_correlation.unwrap() > 0.7);
    }

    #[test]
    fn statistics_over_truths_take_truths_as_units() {
        // Four truths of one parameter; the first family errs by 1, the second by 2, on every arm but the last, where
        // it is the other way round: logs −ln 2 three times and ln 2 once.
        let truths: Vec<DVector<f64>> = [0.0, 1.0, 5.0, -3.0, 10.0].map(|b| DVector::from_vec(vec![b])).to_vec();
        let (units, families, estimators) =
            (DVector::from_element(1, 1.0), ["one".to_owned(), "two".to_owned()], ["ols".to_owned()]);
        let bound = [1.0];
        let designs =
            [0, 1].map(|family| DesignRow { family, start: SharedStart::Fixed, bound_std: &bound, values: &[] });
        let outcome = |design: usize, truth: usize| {
            let error = if (design == 0) == (truth < 4) { 1.0 } else { 2.0 };
            let estimate = ScoredEstimate {
                estimator: "ols".to_owned(),
                failure: None,
                beta: vec![truths[truth][0] + error],
                std: vec![1.0],
                half_width: vec![1.5],
                residual_rms: vec![1.0],
                score: Some(erring(error)),
            };
            Outcome { design, condition: 0, truth, run: truth as u64, failure: None, estimates: vec![estimate] }
        };
        let outcomes: Vec<Outcome> =
            (0..2).flat_map(|d| (1..5).map(move |t| (d, t))).map(|(d, t)| outcome(d, t)).collect();
        let findings = Evidence {
            families: &families,
            compare_with: &[],
            designs: &designs,
            estimators: &estimators,
            truths: truths.len() - 1,
            units: &units,
            runs: &OutcomeTable { outcomes: &outcomes, truths: &truths },
            condition: 0,
            runs_of_noise: 1,
            runs_are_matched: false,
            draws_effects: false,
            seed: Seed::new(1),
        }
        .findings()
        .unwrap();
        let over = findings.over_truths.iter().find(|c| c.metric == Metric::Prediction).unwrap();
        assert_eq!((over.truths, over.first_better), (4, 3));
        // Mean −½ ln 2, standard deviation ln 2, t(3) at 97.5 % = 3.1824.
        assert!((over.ratio - 0.5_f64.sqrt()).abs() < 1e-12, "{}", over.ratio);
        let interval = over.interval.unwrap();
        let half = 3.182_446 * std::f64::consts::LN_2 / 2.0;
        assert!((interval.high.ln() + 0.5 * std::f64::consts::LN_2 - half).abs() < 1e-5, "{interval:?}");
        assert!((over.range.low - 0.5).abs() < 1e-12 && (over.range.high - 2.0).abs() < 1e-12);
        // The error of an estimate is that from its own arm: coverage 3 of 4, where 1 ≤ 1.5 < 2.
        assert!((findings.families[0].parameters[0].bias - 1.25).abs() < 1e-12);
        assert!((findings.families[0].coverage - 0.75).abs() < 1e-12);
    }
}
