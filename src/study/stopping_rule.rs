//! When a study has seen enough: the interval of a ratio of two families is narrow enough, at a look that was declared before.
//!
//! ```text
//! d_k = ȳ_1k − ȳ_2k      ȳ_fk mean over runs of the logarithm of the metric of start k of family f
//! ratio exp( d̄ ),  interval exp( d̄ ± h_j ) at look j, valid under any stopping rule (pocock_bounds)
//! ends where e^{h_j} − 1 < the share that is wanted
//! ```
//! A pair of starts is one unit, however many runs each has: runs of one design share its trajectory and are no replicates of
//! the family. Looks are at 4, 6, 9, 14, … starts, in the order of the starts.

use super::metric::Metric;
use super::plan::StudyPlan;
use super::plan_error::{StudyPlanError, family_name, number};
use crate::remedy::{Remedy, Setting};
use crate::statistics::{Interval, mean, pocock_bounds, repeated_interval};

/// Starts at the first look.
const FIRST_LOOK: usize = 4;

/// Confidence of the intervals of all looks together.
const LEVEL: f64 = 0.95;

/// A wanted half width of the interval of a ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct StoppingRule {
    /// Name of the family in the numerator.
    pub first: String,
    /// Name of the family in the denominator.
    pub second: String,
    /// By which metric.
    pub metric: Metric,
    /// Half width over the ratio, towards the larger side.
    pub share: f64,
}

/// What a look found.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Look {
    /// Starts of each family.
    pub starts: usize,
    /// Pairs of starts that both gave estimates.
    pub pairs: usize,
    /// Bound of the look, in standard deviations of a normal distribution.
    pub bound: f64,
    /// Geometric mean of first over second.
    pub ratio: f64,
    /// Its interval; `None` where it is infinite.
    pub interval: Option<Interval>,
    /// Half width over the ratio.
    pub share: Option<f64>,
}

/// A text is not a stopping rule.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found \"{found}\", expected as \"ratio(condition, d-optimal).prediction < 5 %\", the metric being one of {}", metrics().join(", "))]
pub struct RuleError {
    found: String,
}

/// Metrics of single runs, as a rule names them.
const METRICS: [(&str, Metric); 8] = [
    ("prediction", Metric::Prediction),
    ("prediction-of-rating", Metric::PredictionOfRating),
    ("reference", Metric::Reference),
    ("si", Metric::Si),
    ("measured", Metric::Measured),
    ("slow", Metric::Slow),
    ("point-to-point", Metric::PointToPoint),
    ("static", Metric::Static),
];

fn metrics() -> [&'static str; 8] {
    METRICS.map(|(name, _)| name)
}

impl std::str::FromStr for StoppingRule {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        let parts = || {
            let (names, rest) = text.trim().strip_prefix("ratio(")?.split_once(')')?;
            let (first, second) = names.split_once(',')?;
            let (metric, share) = rest.strip_prefix('.')?.split_once('<')?;
            let (_, metric) = METRICS.into_iter().find(|(name, _)| *name == metric.trim())?;
            let share: f64 = share.trim().strip_suffix('%')?.trim_end().parse().ok()?;
            let names = [first, second].map(|name| name.trim().to_owned());
            let [first, second] = names;
            let possible = share.is_finite() && share > 0.0 && first != second;
            possible.then_some(Self { first, second, metric, share: share / 100.0 })
        };
        parts().ok_or_else(|| RuleError { found: text.to_owned() })
    }
}

impl StoppingRule {
    /// Indices of the two families of a plan.
    ///
    /// # Errors
    /// [`StudyPlanError`] where the plan lacks one of them, they have too few starts or not equally many, or the plan
    /// draws truths: those are the same for all starts, so that more starts say no more about other arms.
    pub fn families(&self, plan: &StudyPlan) -> Result<[usize; 2], StudyPlanError> {
        // As its reader calls it.
        let until = Remedy::default().setting(Setting::Until).to_string();
        let find = |found: &str| {
            let names = plan.designs.iter().map(|family| family.name.as_str());
            names.clone().position(|name| name == found).ok_or_else(|| family_name(until.as_str(), found, names))
        };
        let families = [find(&self.first)?, find(&self.second)?];
        let starts = families.map(|family| plan.designs[family].starts);
        if starts[0] != starts[1] {
            return Err(number("design.starts", starts[1], "as many as the other family of the stopping rule"));
        }
        if starts[0] < FIRST_LOOK {
            return Err(number("design.starts", starts[0], "at least 4, the first look of the stopping rule"));
        }
        if let Some(truths) = plan.truths.as_ref().filter(|truths| truths.count > 1) {
            return Err(number("truths.count", truths.count, "one arm: its starts are the units of the stopping rule"));
        }
        Ok(families)
    }

    /// Numbers of starts at which a study of at most `starts` is looked at, and the bound of each look.
    pub fn looks(starts: usize) -> Vec<(usize, f64)> {
        let mut looks = Vec::new();
        let mut next = FIRST_LOOK;
        while next < starts {
            looks.push(next);
            next = (next * 3).div_ceil(2);
        }
        looks.push(starts);
        let fractions: Vec<f64> = looks.iter().map(|&look| look as f64 / starts as f64).collect();
        looks.into_iter().zip(pocock_bounds(&fractions, LEVEL)).collect()
    }

    /// The logarithm of the ratio of a pair of starts by the values of their runs; `None` where one of them has none.
    pub fn log_ratio(first: &[f64], second: &[f64]) -> Option<f64> {
        let mean_log = |values: &[f64]| {
            let logs: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
            (!logs.is_empty()).then(|| mean(&logs))
        };
        Some(mean_log(first)? - mean_log(second)?)
    }

    /// The interval by the logarithms of the ratios of all pairs of starts so far.
    pub fn look(starts: usize, bound: f64, logs: &[f64]) -> Look {
        let interval = repeated_interval(logs, bound);
        Look {
            starts,
            pairs: logs.len(),
            bound,
            ratio: libm::exp(mean(logs)),
            interval: interval.map(Interval::exponentiated),
            share: interval.map(|i| libm::expm1(0.5 * (i.high - i.low))),
        }
    }

    /// Is the interval of a look as narrow as is wanted?
    pub fn is_met(&self, look: &Look) -> bool {
        look.share.is_some_and(|share| share < self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand_distr::{Distribution, StandardNormal};

    const PLAN: &str = include_str!("../../experiments/01-criteria/study.toml");

    #[test]
    fn rules_are_read_and_faults_are_said() {
        let rule: StoppingRule = "ratio(condition, d-optimal).prediction < 5 %".parse().unwrap();
        assert_eq!((rule.first.as_str(), rule.second.as_str(), rule.share), ("condition", "d-optimal", 0.05));
        assert_eq!("ratio(a,b).si<0.5%".parse::<StoppingRule>().unwrap().metric, Metric::Si);
        for text in [
            "",
            "ratio(a, a).si < 5 %",
            "ratio(a).si < 5 %",
            "ratio(a, b).volume < 5 %",
            "ratio(a, b).si < 5",
            "ratio(a, b).si < -5 %",
            "ratio(a, b).si < nan %",
        ] {
            let fault = text.parse::<StoppingRule>().unwrap_err().to_string();
            assert!(fault.contains("expected as \"ratio(") && fault.contains(text), "{fault}");
        }
        let plan = StudyPlan::from_toml(PLAN).unwrap();
        assert!(rule.families(&plan).is_ok());
        let other = StoppingRule { first: "nobody".to_owned(), ..rule.clone() };
        assert!(other.families(&plan).unwrap_err().to_string().contains("`until` is \"nobody\""));
        let drawn = |count| StudyPlan { truths: Some(crate::study::RandomTruths::new(count)), ..plan.clone() };
        assert!(rule.families(&drawn(1)).is_ok());
        assert!(rule.families(&drawn(2)).unwrap_err().to_string().contains("truths.count"));
        let mut few = plan.clone();
        few.designs.iter_mut().for_each(|family| family.starts = family.starts.min(3));
        assert!(rule.families(&few).unwrap_err().to_string().contains("at least 4"));
    }

    #[test]
    fn looks_rise_to_the_largest_number_of_starts() {
        for (starts, expected) in
            [(4, vec![4]), (5, vec![4, 5]), (20, vec![4, 6, 9, 14, 20]), (21, vec![4, 6, 9, 14, 21])]
        {
            let looks = StoppingRule::looks(starts);
            assert_eq!(looks.iter().map(|look| look.0).collect::<Vec<_>>(), expected);
            assert!(looks.iter().all(|look| look.1 > 1.95 && look.1 < 3.2), "{looks:?}");
        }
    }

    #[test]
    fn statistics_starts_are_units_and_runs_are_not() {
        // A start differs by 0.3 from start to start, a run by 0.05 from run to run; 20 runs of each start. The half width at
        // 95 % of 40 pairs is that of 40 numbers, 2.02 · 0.3 √2 / √40 = 0.136, within a factor for the looks.
        let mut rng = Seed::new(2).stream("starts", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let logs: Vec<f64> = (0..40)
            .map(|_| {
                let mut mean_of = || {
                    let start = 0.3 * normal();
                    (0..20).map(|_| start + 0.05 * normal()).sum::<f64>() / 20.0
                };
                mean_of() - mean_of()
            })
            .collect();
        let (starts, bound) = StoppingRule::looks(40)[6];
        assert_eq!(starts, 40);
        let look = StoppingRule::look(starts, bound, &logs);
        let share = look.share.unwrap();
        assert!((0.1..0.26).contains(&share), "{look:?}");
        assert!(look.interval.unwrap().contains(1.0));
        let rule = StoppingRule { share: share * 1.001, ..("ratio(a, b).si < 1 %".parse().unwrap()) };
        assert!(rule.is_met(&look) && !StoppingRule { share, ..rule }.is_met(&look));
    }
}
