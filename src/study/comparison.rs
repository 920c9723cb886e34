//! The difference between two families of designs in one metric, with its interval.
//!
//! ```text
//! y_k = mean over the runs of design k of ln(metric)
//! paired    d_k = y_1k − y_2k of designs that share their start       ratio exp( d̄ ± t_{n−1} s_d/√n )
//! crossed   the same for each draw of effects that all designs share: pairs × draws, an interval over both
//! else      Welch's interval of ȳ_1 − ȳ_2                             ratio exp of its ends
//! better    where Holm's adjusted p over all pairs of one metric, estimator and condition is below 0.05
//! ```
//! Only a log volume, which is of all runs together, is drawn again ([`Replication::Resampled`]).

use super::error::StudyError;
use super::estimator_runs::EstimatorRuns;
use super::evidence::{Evidence, LEVEL, RunValues};
use super::family_score::{VOLUME_RESAMPLES, VOLUME_RUNS};
use super::metric::Metric;
use super::replication::Replication;
use super::shared_start::SharedStart;
use super::volume::ErrorVolumes;
use crate::seed::Seed;
use crate::statistics::{
    Interval, MeanDifference, crossed_difference, holm_adjusted, mean, paired_difference, welch_difference,
};

/// The difference between two families of designs in one metric.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// The metric.
    pub metric: Metric,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the first family.
    pub first: String,
    /// Name of the second family.
    pub second: String,
    /// First over second, geometric mean over units; for a logarithmic metric first minus second. Below 1 (0): the first is better.
    pub difference: f64,
    /// Its 95 % interval, of this comparison alone; `None` where either family has one unit, and of a log volume of few runs.
    pub interval: Option<Interval>,
    /// What is repeated independently; `None` where there is no interval.
    #[serde(default)]
    pub unit: Option<Replication>,
    /// Degrees of freedom of Student's t.
    #[serde(default)]
    pub degrees_of_freedom: Option<f64>,
    /// Two-sided p-value of no difference.
    #[serde(default)]
    pub p: Option<f64>,
    /// The p-value adjusted for all pairs of families compared in this metric with this estimator under this condition (Holm).
    #[serde(default)]
    pub p_adjusted: Option<f64>,
    /// The better family, where the adjusted p is below 0.05; of a log volume, where the interval excludes no difference.
    pub better: Option<String>,
}

impl Evidence<'_> {
    /// Compares families pair by pair by the logarithms of a metric of single runs; `None` where one of a pair has no value.
    pub(super) fn compare(
        &self,
        metric: Metric,
        runs: &EstimatorRuns<'_>,
        pairs: &[[usize; 2]],
        logs: &RunValues,
    ) -> Vec<Option<Comparison>> {
        let mut found: Vec<Option<Comparison>> =
            pairs.iter().map(|&pair| self.compare_pair(metric, runs, pair, logs)).collect();
        let p: Vec<f64> = found.iter().flatten().filter_map(|comparison| comparison.p).collect();
        let tested = found.iter_mut().flatten().filter(|comparison| comparison.p.is_some());
        for (comparison, adjusted) in tested.zip(holm_adjusted(&p)) {
            comparison.p_adjusted = Some(adjusted);
            comparison.better = comparison.smaller().filter(|_| adjusted < 1.0 - LEVEL);
        }
        found
    }

    fn compare_pair(
        &self,
        metric: Metric,
        runs: &EstimatorRuns<'_>,
        pair: [usize; 2],
        logs: &RunValues,
    ) -> Option<Comparison> {
        let units = pair.map(|family| self.units_of(family, runs, logs));
        let sides = units.each_ref().map(|units| units.values());
        // An error of zero has no logarithm.
        if sides.iter().any(|values| values.is_empty() || !mean(values).is_finite()) {
            return None;
        }
        let crossed = crossed_difference(&self.differences_by_draw(runs, pair, logs), LEVEL);
        if let Some(found) = crossed {
            let unit = Replication::PairedDesignsAndDraws;
            return Some(self.of_means(metric, runs.name, pair, unit, &found));
        }
        let matched = self.matched_differences([&units[0], &units[1]]);
        let found = match &matched {
            Some((unit, differences)) => paired_difference(differences, LEVEL).map(|found| (*unit, found)),
            None => welch_difference(&sides[0], &sides[1], LEVEL).map(|found| {
                let unit = match units.each_ref().map(|units| units.are_designs) {
                    [true, true] => Replication::Designs,
                    [false, false] => Replication::Runs,
                    [true, false] | [false, true] => Replication::DesignsAndRuns,
                };
                (unit, found)
            }),
        };
        let without = || self.comparison(metric, runs.name, pair, libm::exp(mean(&sides[0]) - mean(&sides[1])));
        Some(found.map_or_else(without, |(unit, found)| self.of_means(metric, runs.name, pair, unit, &found)))
    }

    /// The differences of designs that share their start, one row each, under each draw of effects; none where nothing is drawn.
    /// Pairs that lack a value under one of the draws are left out.
    fn differences_by_draw(&self, runs: &EstimatorRuns<'_>, pair: [usize; 2], logs: &RunValues) -> Vec<Vec<f64>> {
        if !self.draws_effects {
            return Vec::new();
        }
        let of_draw = |design: usize, draw: usize| {
            let values = logs[design].iter().zip(&runs.truths[design]).filter(|(_, truth)| **truth == draw);
            let values: Vec<f64> = values.filter_map(|(log, _)| *log).collect();
            (!values.is_empty()).then(|| mean(&values))
        };
        let [first, second] = pair.map(|family| self.designs_of(family));
        let start = |design: usize| self.designs[design].start;
        let partner = |design: &usize| {
            let shares = |other: &&usize| start(**other) == start(*design) && start(*design) != SharedStart::Fixed;
            second.iter().find(shares).map(|&other| (*design, other))
        };
        let row = |(design, other)| {
            (1..=self.truths).map(|draw| Some(of_draw(design, draw)? - of_draw(other, draw)?)).collect()
        };
        first.iter().filter_map(partner).filter_map(row).collect()
    }

    /// The comparison by the difference of two means of logarithms.
    fn of_means(
        &self,
        metric: Metric,
        estimator: &str,
        pair: [usize; 2],
        unit: Replication,
        found: &MeanDifference,
    ) -> Comparison {
        Comparison {
            interval: Some(found.interval.exponentiated()),
            unit: Some(unit),
            degrees_of_freedom: Some(found.degrees_of_freedom),
            p: Some(found.p),
            ..self.comparison(metric, estimator, pair, libm::exp(found.difference))
        }
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
            let drawn = volumes
                .interval(runs, &sides, VOLUME_RESAMPLES, LEVEL, seed, |values| Some(values[0]? - values[1]?))?;
            drawn.filter(|interval| interval.contains(first - second))
        };
        let found = self.comparison(metric, runs.name, pair, first - second);
        let decided = interval.is_some_and(|interval| !interval.contains(0.0));
        let better = found.smaller().filter(|_| decided);
        Ok(Some(Comparison { interval, unit: interval.map(|_| Replication::Resampled), better, ..found }))
    }

    /// The log volumes of the errors of runs.
    pub(super) fn volumes(&self, runs: &EstimatorRuns<'_>) -> ErrorVolumes<'_> {
        ErrorVolumes { runs: self.runs, condition: self.condition, estimator: runs.index, units: self.units }
    }

    fn pair_seed(&self, metric: Metric, estimator: &str, pair: [usize; 2]) -> Seed {
        self.seed.child(&format!("{estimator} {metric:?}"), (pair[0] * self.families.len() + pair[1]) as u64)
    }

    /// A comparison of which the difference alone is known.
    fn comparison(&self, metric: Metric, estimator: &str, pair: [usize; 2], difference: f64) -> Comparison {
        Comparison {
            metric,
            estimator: estimator.to_owned(),
            first: self.families[pair[0]].clone(),
            second: self.families[pair[1]].clone(),
            difference,
            ..Comparison::default()
        }
    }
}

impl Comparison {
    /// The comparison with the family `reference` behind: another over it. `None` where it is neither of the two.
    #[must_use]
    pub fn over(&self, reference: &str) -> Option<Self> {
        if self.second == reference {
            return Some(self.clone());
        }
        (self.first == reference).then(|| self.turned())
    }

    /// Second over first: the inverse of a ratio, the negative of a difference, each with its interval.
    pub(super) fn turned(&self) -> Self {
        let turned = |x: f64| if self.metric.is_logarithmic() { -x } else { 1.0 / x };
        Self {
            first: self.second.clone(),
            second: self.first.clone(),
            difference: turned(self.difference),
            interval: self.interval.map(|i| Interval { low: turned(i.high), high: turned(i.low) }),
            ..self.clone()
        }
    }

    /// The family with the smaller value; `None` of equal ones.
    fn smaller(&self) -> Option<String> {
        let none = if self.metric.is_logarithmic() { 0.0 } else { 1.0 };
        match self.difference.partial_cmp(&none)? {
            std::cmp::Ordering::Less => Some(self.first.clone()),
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => Some(self.second.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::study::evidence::Findings;
    use crate::study::run_table::RunNumber;
    use crate::study::{DesignRow, RunTable, StatusCount};

    /// One error of each run of each design, the same by every metric of single runs and of its only parameter.
    #[derive(Debug)]
    struct Errors {
        errors: Vec<Vec<Option<f64>>>,
        /// Whether run r is on the arm of draw r + 1.
        draws: bool,
    }

    impl RunTable for Errors {
        fn runs(&self, design: usize, _: usize) -> usize {
            self.errors[design].len()
        }

        fn numbers(
            &self,
            design: usize,
            _: usize,
            range: std::ops::Range<usize>,
            number: RunNumber,
        ) -> Result<Vec<Option<f64>>, StudyError> {
            Ok(match number {
                RunNumber::Truth if self.draws => range.map(|run| Some(run as f64 + 1.0)).collect(),
                RunNumber::Metric { metric: Metric::Measured, .. } | RunNumber::Truth => vec![None; range.len()],
                _ => self.errors[design][range].to_vec(),
            })
        }

        fn statuses(&self, _: usize) -> Vec<StatusCount> {
            Vec::new()
        }
    }

    /// The findings of families, each with its designs: where their search began, and the errors of their runs.
    fn findings(
        families: Vec<Vec<(SharedStart, Vec<Option<f64>>)>>,
        runs_of_noise: usize,
        runs_are_matched: bool,
    ) -> Findings {
        findings_of_draws(families, runs_of_noise, runs_are_matched, 0)
    }

    /// Findings if each run has one of so many draws of effects.
    fn findings_of_draws(
        families: Vec<Vec<(SharedStart, Vec<Option<f64>>)>>,
        runs_of_noise: usize,
        runs_are_matched: bool,
        draws: usize,
    ) -> Findings {
        let names: Vec<String> = (0..families.len()).map(|family| format!("family {family}")).collect();
        let (mut designs, mut errors) = (Vec::new(), Vec::new());
        for (family, of_family) in families.into_iter().enumerate() {
            for (start, runs) in of_family {
                designs.push(DesignRow { family, start, bound_std: &[1.0], values: &[] });
                errors.push(runs);
            }
        }
        Evidence {
            families: &names,
            compare_with: &[],
            designs: &designs,
            estimators: &["wls".to_owned()],
            truths: draws,
            units: &DVector::from_element(1, 1.0),
            runs: &Errors { errors, draws: draws > 0 },
            condition: 0,
            runs_of_noise,
            runs_are_matched,
            draws_effects: draws > 0,
            seed: Seed::new(1),
        }
        .findings()
        .unwrap()
    }

    fn by_prediction(found: Findings) -> Vec<Comparison> {
        found.comparisons.into_iter().filter(|c| c.metric == Metric::Prediction).collect()
    }

    fn all(errors: &[f64]) -> Vec<Option<f64>> {
        errors.iter().copied().map(Some).collect()
    }

    /// Upper end of the interval of logarithms with mean `m` and standard error `s`, over exp m.
    fn above(t: f64, s: f64) -> f64 {
        libm::exp(t * s)
    }

    const LN_2: f64 = std::f64::consts::LN_2;
    /// Student's 97.5 % quantiles with 1 and 2 degrees of freedom.
    const T_1: f64 = 12.706_204_736_174_7;
    const T_2: f64 = 4.302_652_729_911_275;

    #[test]
    fn analytic_designs_from_the_same_start_are_pairs() {
        // Ratios of pairs: 1/2 and 1/8, whatever the starts are worth and in which order they stand; runs are means of logarithms.
        let first = vec![(SharedStart::Guess(0), all(&[1.0, 4.0])), (SharedStart::Guess(1), all(&[0.5, 0.5]))];
        let second = vec![(SharedStart::Guess(1), all(&[4.0, 4.0])), (SharedStart::Guess(0), all(&[4.0, 4.0]))];
        let found = by_prediction(findings(vec![first, second], 1, false)).remove(0);
        assert_eq!((found.unit, found.degrees_of_freedom), (Some(Replication::PairedDesigns), Some(1.0)));
        assert!((found.difference - 0.25).abs() < 1e-14);
        // Logarithms −ln 2 and −3 ln 2: standard deviation √2 ln 2, standard error ln 2, t = −2.
        let high = found.interval.unwrap().high;
        assert!((high / (0.25 * above(T_1, LN_2)) - 1.0).abs() < 1e-9, "{high}");
        assert!((found.p.unwrap() - (1.0 - 2.0_f64.atan() / std::f64::consts::FRAC_PI_2)).abs() < 1e-12);
        assert_eq!(found.better, None);
    }

    #[test]
    fn analytic_draws_that_all_designs_share_are_units_beside_designs() {
        let family = |errors: [[f64; 2]; 2]| {
            errors.iter().enumerate().map(|(k, of)| (SharedStart::Guess(k), all(of))).collect::<Vec<_>>()
        };
        let of =
            |first, second| by_prediction(findings_of_draws(vec![family(first), family(second)], 1, true, 2)).remove(0);
        let unit = Some(Replication::PairedDesignsAndDraws);
        // Ratios of 1/2 and 1/8 whatever the draw, and of 1/2 and 1/8 whatever the design: standard error ln 2 either way.
        for second in [[[2.0, 4.0], [8.0, 8.0]], [[2.0, 16.0], [2.0, 8.0]]] {
            let found = of([[1.0, 2.0], [1.0, 1.0]], second);
            assert_eq!((found.unit, found.degrees_of_freedom), (unit, Some(1.0)), "{found:?}");
            assert!((found.difference - 0.25).abs() < 1e-14);
            assert!((found.interval.unwrap().high / (0.25 * above(T_1, LN_2)) - 1.0).abs() < 1e-9, "{found:?}");
        }
        // Designs and draws together: standard error √2 ln 2 with two degrees of freedom.
        let both = of([[1.0; 2]; 2], [[1.0, 4.0], [4.0, 16.0]]);
        assert!((both.degrees_of_freedom.unwrap() - 2.0).abs() < 1e-12);
        let high = both.interval.unwrap().high;
        assert!((high / (0.25 * above(T_2, std::f64::consts::SQRT_2 * LN_2)) - 1.0).abs() < 1e-9, "{high}");
    }

    #[test]
    fn analytic_a_comparison_turned_round_is_the_inverse_or_the_negative() {
        let of = |metric, [low, difference, high]: [f64; 3]| {
            crate::study::small_results::compared(metric, ["a", "b"], [low, difference, high], Some(1))
        };
        let ratio = of(Metric::Si, [0.5, 2.0, 4.0]);
        assert_eq!((ratio.over("b"), ratio.over("c")), (Some(ratio.clone()), None));
        let inverse = ratio.over("a").unwrap();
        assert_eq!((inverse.first.as_str(), inverse.second.as_str(), inverse.better.as_deref()), ("b", "a", Some("b")));
        assert_eq!((inverse.difference, inverse.interval), (0.5, Some(Interval { low: 0.25, high: 2.0 })));
        let negative = of(Metric::LogVolume, [-1.0, 2.0, 3.0]).over("a").unwrap();
        assert_eq!((negative.difference, negative.interval), (-2.0, Some(Interval { low: -3.0, high: 1.0 })));
        for c in [ratio, of(Metric::LogVolume, [-1.0, 2.0, 3.0])] {
            assert_eq!(c.over("a").unwrap().over("b"), Some(c));
        }
    }

    #[test]
    fn analytic_designs_without_a_common_start_are_two_samples() {
        let guess = |errors: &[f64]| {
            errors.iter().enumerate().map(|(k, &error)| (SharedStart::Guess(k), all(&[error]))).collect::<Vec<_>>()
        };
        let draws = |errors: &[f64]| {
            errors.iter().enumerate().map(|(k, &error)| (SharedStart::Draws(k), all(&[error]))).collect::<Vec<_>>()
        };
        // Equal scatter and size: Welch's degrees of freedom are 2 (n − 1), the standard error √(2 ln²2 · 2/2) = √2 ln 2.
        let found = by_prediction(findings(vec![guess(&[1.0, 4.0]), draws(&[8.0, 2.0])], 1, true)).remove(0);
        assert_eq!(found.unit, Some(Replication::Designs));
        assert!((found.degrees_of_freedom.unwrap() - 2.0).abs() < 1e-12 && (found.difference - 0.5).abs() < 1e-14);
        let high = found.interval.unwrap().high;
        assert!((high / (0.5 * above(T_2, std::f64::consts::SQRT_2 * LN_2)) - 1.0).abs() < 1e-9, "{high}");
    }

    #[test]
    fn analytic_a_family_of_one_design_has_its_runs_as_units() {
        let fixed = |errors: &[f64]| vec![(SharedStart::Fixed, all(errors))];
        let several = vec![(SharedStart::Guess(0), all(&[1.0; 3])), (SharedStart::Guess(1), all(&[4.0; 3]))];
        let unit = |found: Findings| by_prediction(found).remove(0);
        let mixed = unit(findings(vec![several, fixed(&[2.0, 2.0, 2.0, 2.0])], 1, false));
        // The runs do not scatter: the designs alone decide, with one degree of freedom.
        assert_eq!((mixed.unit, mixed.degrees_of_freedom), (Some(Replication::DesignsAndRuns), Some(1.0)));
        let two = || vec![fixed(&[1.0, 2.0, 4.0]), fixed(&[2.0, 4.0, 8.0])];
        let alone = unit(findings(two(), 1, false));
        assert_eq!((alone.unit, alone.better.as_deref()), (Some(Replication::Runs), None));
        // Run by run on the same arm the ratio is 1/2 each time.
        let paired = unit(findings(two(), 1, true));
        assert_eq!((paired.unit, paired.better.as_deref()), (Some(Replication::PairedRuns), Some("family 0")));
        assert!((paired.interval.unwrap().high - 0.5).abs() < 1e-12);
        // A run that gave nothing leaves its partner alone; one value is no sample.
        let gap = vec![
            vec![(SharedStart::Fixed, vec![Some(1.0), None, Some(4.0), Some(8.0)])],
            vec![(SharedStart::Fixed, vec![Some(2.0), Some(4.0), None, Some(8.0)])],
        ];
        let gap = unit(findings(gap, 1, true));
        assert!((gap.difference - 0.5_f64.sqrt()).abs() < 1e-14 && gap.degrees_of_freedom == Some(1.0), "{gap:?}");
        let single = unit(findings(vec![fixed(&[1.0]), fixed(&[2.0])], 1, false));
        assert_eq!((single.interval, single.unit, single.p, single.better), (None, None, None, None));
        // Opposite noise: four runs are two units.
        let antithetic = vec![fixed(&[1.0, 4.0, 4.0, 4.0]), fixed(&[8.0, 8.0, 16.0, 16.0])];
        let antithetic = unit(findings(antithetic, 2, true));
        assert_eq!((antithetic.unit, antithetic.degrees_of_freedom), (Some(Replication::PairedRuns), Some(1.0)));
    }

    #[test]
    fn analytic_p_values_are_adjusted_for_all_pairs_of_families() {
        let family = |scale: f64| {
            let wobble = [1.0, 1.3, 0.9, 1.1];
            let of = |k: usize| scale * wobble[(k + scale as usize) % 4];
            (0..4).map(|k| (SharedStart::Guess(k), all(&[of(k)]))).collect::<Vec<_>>()
        };
        let found = by_prediction(findings(vec![family(1.0), family(2.0), family(2.0), family(3.0)], 1, false));
        let p: Vec<f64> = found.iter().map(|c| c.p.unwrap()).collect();
        assert_eq!(p.len(), 6);
        let adjusted: Vec<f64> = found.iter().map(|c| c.p_adjusted.unwrap()).collect();
        let least = p.iter().copied().fold(1.0, f64::min);
        assert!((adjusted.iter().copied().fold(1.0, f64::min) - 6.0 * least).abs() < 1e-15);
        for c in &found {
            assert_eq!(c.better.is_some(), c.p_adjusted.unwrap() < 0.05, "{c:?}");
            assert!(c.better.is_none() || !c.interval.unwrap().contains(1.0), "{c:?}");
        }
        // The second and the third family are the same: no surprise.
        let same = found.iter().find(|c| c.first == "family 1" && c.second == "family 2").unwrap();
        assert_eq!((same.p, same.better.as_deref()), (Some(1.0), None));
    }

    #[test]
    fn identity_no_interval_excludes_its_own_estimate() {
        for study in 0..60 {
            let mut rng = Seed::new(9).stream("study", study);
            let mut families = Vec::new();
            for family in 0..3_usize {
                let designs = rng.random_range(1..5);
                let mut of_family = Vec::new();
                for k in 0..designs {
                    let start = [SharedStart::Guess(k), SharedStart::Guess(k), SharedStart::Draws(k)][family];
                    let design: f64 = StandardNormal.sample(&mut rng);
                    let runs = (0..6).map(|_| {
                        let run: f64 = StandardNormal.sample(&mut rng);
                        (rng.random::<f64>() < 0.8).then(|| libm::exp(3.0 * design + run))
                    });
                    of_family.push((start, runs.collect()));
                }
                families.push(of_family);
            }
            let found = findings(families, 1 + study as usize % 2, study % 3 == 0);
            for c in &found.comparisons {
                assert!(c.interval.is_none_or(|interval| interval.contains(c.difference)), "{c:?}");
            }
            for score in &found.families {
                for (value, interval) in score.values.iter().zip(&score.intervals) {
                    assert!(interval.is_none_or(|interval| interval.contains(value.unwrap())), "{score:?}");
                }
            }
        }
    }
}
