//! From the outcomes of all runs to the findings of a study: per design, per family of designs, per parameter, and the
//! differences between families with their intervals.
//!
//! ```text
//! family value     geometric mean over its runs of the RMSE          (no single bad design decides)
//! difference       ratio of two family values, 95 % interval by bootstrap over designs and runs
//! log volume       ½ ln det( mean over all runs of z zᵀ ),  z_i = e_i / u_i
//! bias             mean error; its interval takes designs as the units where there are at least two
//! ```
//! Metrics stand in the order in which they decide: torque prediction first.

use nalgebra::DVector;

use super::comparison::Comparison;
use super::criterion_correlation::CriterionCorrelation;
use super::family_score::FamilyScore;
use super::metric::Metric;
use super::outcome::{Outcome, ScoredEstimate};
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
    /// Cramér–Rao standard deviations (b).
    pub bound_std: &'a [f64],
    /// Values that may predict its error, by name.
    pub values: &'a [(&'a str, f64)],
}

/// The input of the findings: designs, truths and all outcomes.
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
    /// True base parameters (b) of the robot, and of each truth that was drawn; [`Outcome::truth`] is an index.
    pub truths: &'a [DVector<f64>],
    /// Reference units (b).
    pub units: &'a DVector<f64>,
    /// All outcomes, sorted by design and run.
    pub outcomes: &'a [Outcome],
    /// Seed of the bootstraps.
    pub seed: Seed,
}

/// Scores, comparisons and correlations over all outcomes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Findings {
    /// The score of every family with every estimator.
    pub families: Vec<FamilyScore>,
    /// The comparison of every pair of families, in every metric, with every estimator.
    pub comparisons: Vec<Comparison>,
    /// The same over random truths, where the study draws them.
    #[serde(default)]
    pub over_truths: Vec<TruthComparison>,
    /// Median over runs of the prediction RMSE of each design (outer: estimator, inner: design), N·m.
    pub design_prediction: Vec<Vec<Option<Spread>>>,
    /// How well criterion values predict the error.
    #[serde(rename = "foretelling")]
    pub criterion_correlations: Vec<CriterionCorrelation>,
}

/// One estimate, and the true base parameters of the arm that it was made from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run<'a> {
    pub(super) estimate: &'a ScoredEstimate,
    pub(super) beta: &'a DVector<f64>,
    pub(super) truth: usize,
}

impl Run<'_> {
    /// Error of base parameter `i`.
    pub(super) fn error(&self, i: usize) -> f64 {
        self.estimate.beta[i] - self.beta[i]
    }

    /// Errors of all base parameters (b).
    pub(super) fn errors(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.estimate.beta) - self.beta
    }
}

/// The runs of one family with one estimator: design → run.
pub(super) type FamilyRuns<'a> = Vec<Vec<Run<'a>>>;

impl Evidence<'_> {
    /// Computes the findings.
    #[must_use]
    pub fn findings(&self) -> Findings {
        let mut findings = Findings {
            families: Vec::new(),
            comparisons: Vec::new(),
            over_truths: Vec::new(),
            design_prediction: Vec::new(),
            criterion_correlations: Vec::new(),
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
                        findings.over_truths.extend(self.over_truths(metric, estimator, [first, second], &runs));
                    }
                }
            }
            let spread = self.design_spread(e);
            findings.criterion_correlations.extend(self.criterion_correlations(estimator, &spread));
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
                    .filter_map(|outcome| {
                        let estimate = outcome.estimates.get(estimator).filter(|estimate| estimate.score.is_some())?;
                        Some(Run { estimate, beta: &self.truths[outcome.truth], truth: outcome.truth })
                    })
                    .collect()
            })
            .collect()
    }

    /// Number of base parameters b.
    pub(super) fn parameters(&self) -> usize {
        self.units.len()
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Failure, FailureKind, Score};
    use rand_distr::{Distribution, StandardNormal};

    /// Two families of 6 designs × 20 runs, b = 3, white errors of standard deviation 1 and 2, honest intervals.
    fn findings() -> Findings {
        let truths = [DVector::from_vec(vec![1.0, -2.0, 0.0])];
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
                        score: Some(Score {
                            prediction_rmse_nm: rmse,
                            prediction_rmse_of_rating: rmse,
                            joint_rmse_nm: vec![rmse],
                            reference_rmse: rmse,
                            si_rmse: rmse,
                            measured_rmse_nm: None,
                        }),
                    }],
                });
            }
        }
        let failure = Some(Failure { kind: FailureKind::DivergedSpeed, reason: "too fast".to_owned() });
        outcomes.push(Outcome { design: 11, condition: 0, truth: 0, run: 20, failure, estimates: Vec::new() });
        let estimators = ["ols".to_owned()];
        Evidence {
            families: &families,
            compare_with: &[],
            designs: &designs,
            estimators: &estimators,
            truths: &truths,
            units: &units,
            outcomes: &outcomes,
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
        let designs = [0, 1].map(|family| DesignRow { family, bound_std: &bound, values: &[] });
        let outcome = |design: usize, truth: usize| {
            let error = if (design == 0) == (truth < 4) { 1.0 } else { 2.0 };
            let score = Score {
                prediction_rmse_nm: error,
                prediction_rmse_of_rating: error,
                joint_rmse_nm: vec![error],
                reference_rmse: error,
                si_rmse: error,
                measured_rmse_nm: None,
            };
            let estimate = ScoredEstimate {
                estimator: "ols".to_owned(),
                failure: None,
                beta: vec![truths[truth][0] + error],
                std: vec![1.0],
                half_width: vec![1.5],
                residual_rms: vec![1.0],
                score: Some(score),
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
            truths: &truths,
            units: &units,
            outcomes: &outcomes,
            seed: Seed::new(1),
        }
        .findings();
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
