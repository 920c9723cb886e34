//! Errors of criteria relative to one of them by the size of an unmodelled effect, and the size at which the lead of that one ends.
//!
//! ```text
//! ρ(s)     error of a criterion over that of the reference at size s, geometric mean over designs
//! lead     ρ(0) > 1: with an exact model the reference is better
//! its end  the smallest s with ρ(s) = 1. Between two sizes ln ρ is linear in ln s; below the first size in s², as noise and
//!          bias add as squares
//! ```
//! The interval of the end holds the sizes at which the interval of ρ holds 1.

use super::comparison::Comparison;
use super::criterion_ratios::{REFERENCE, designs_of_reference};
use super::metric::Metric;
use super::result::StudyResult;
use super::robots_summary::RobotDifference;
use crate::experiment::{EffectKind, Effects, Level};
use crate::model::distinct;

/// Metrics that are followed over the size of an effect.
const METRICS: [Metric; 3] = [Metric::Prediction, Metric::Measured, Metric::Reference];

/// Errors relative to the reference by the size of one effect, on one robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectLevels {
    /// Name of the robot.
    pub robot: String,
    /// The criterion that the others are compared with.
    pub reference: String,
    /// Number of its designs.
    pub designs: usize,
    /// Name of the effect; of several that grow together, all names.
    pub effect: String,
    /// Unit of the sizes: that of the effect, empty for a share. Sizes of several effects are shares of their realistic levels.
    pub unit: String,
    /// The sizes, ascending from 0.
    pub sizes: Vec<f64>,
    /// The ratios, by criterion and metric.
    pub ratios: Vec<LevelRatios>,
}

/// One criterion in one metric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelRatios {
    /// Name of the designs.
    pub criterion: String,
    /// The metric.
    pub metric: Metric,
    /// Error over that of the reference at each size.
    pub errors: Vec<RobotDifference>,
    /// Where the lead of the reference ends.
    pub lead: Lead,
}

/// The lead of the reference over a criterion, as an effect grows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lead {
    /// There is none with an exact model.
    None,
    /// It ends at none of the sizes.
    Remains,
    /// It ends at this size.
    Ends {
        /// The size, in the unit of the effect.
        size: f64,
        /// Smallest size at which the interval of the ratio holds 1.
        low: f64,
        /// Largest such size; `None` if that is beyond all sizes.
        high: Option<f64>,
    },
}

impl EffectLevels {
    /// Every effect that a study has in at least two sizes beside none, last estimator, first engine.
    pub fn from_result(result: &StudyResult) -> Vec<Self> {
        let plan = &result.plan;
        let engine = plan.engines.first();
        let parts = result.conditions.iter().filter(|part| Some(&part.condition.engine) == engine);
        let sized: Vec<_> =
            parts.map(|part| (part, Size::of(&plan.effects.overridden_by(&part.condition.effects)))).collect();
        let kinds = sized.iter().filter_map(|(_, size)| Some(&size.as_ref()?.kinds[..]));
        let kinds = distinct(kinds.filter(|kinds| !kinds.is_empty()));
        let Some(estimator) = plan.identification.estimators.last() else { return Vec::new() };
        let over = |comparisons: &[Comparison], metric: Metric| -> Vec<Comparison> {
            let of = comparisons.iter().filter(|c| c.metric == metric && c.estimator == *estimator);
            of.filter_map(|c| c.over(REFERENCE)).collect()
        };
        let of_effect = |kinds: &[EffectKind]| {
            let mut steps: Vec<_> = sized
                .iter()
                .filter_map(|(part, size)| Some((size.as_ref()?, part)))
                .filter(|(size, _)| size.kinds.is_empty() || size.kinds == kinds)
                .map(|(size, part)| (size.value, &part.findings.comparisons))
                .collect();
            steps.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let sizes: Vec<f64> = steps.iter().map(|(size, _)| *size).collect();
            if sizes.len() < 3 || sizes[0] > 0.0 || sizes[1] <= 0.0 {
                return None;
            }
            let mut ratios = Vec::new();
            for metric in METRICS {
                let found: Vec<Vec<Comparison>> = steps.iter().map(|(_, all)| over(all, metric)).collect();
                for design in plan.designs.iter().filter(|design| design.name != REFERENCE) {
                    let at =
                        |step: &Vec<Comparison>| step.iter().find(|c| c.first == design.name).map(RobotDifference::of);
                    let errors: Option<Vec<RobotDifference>> = found.iter().map(at).collect();
                    ratios.extend(errors.map(|errors| LevelRatios {
                        criterion: design.name.clone(),
                        metric,
                        lead: Lead::of(&sizes, &errors),
                        errors,
                    }));
                }
            }
            let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
            Some(Self {
                robot: result.provenance.robot.clone(),
                reference: REFERENCE.to_owned(),
                designs: designs_of_reference(result),
                effect: names.join(" and "),
                unit: if let [kind] = kinds { kind.entry().unit.to_owned() } else { String::new() },
                sizes,
                ratios,
            })
        };
        kinds.into_iter().filter_map(of_effect).filter(|levels| !levels.ratios.is_empty()).collect()
    }
}

/// Effects of one scenario, and how strong they are.
struct Size {
    kinds: Vec<EffectKind>,
    value: f64,
}

impl Size {
    /// `None` where several effects are at different shares of their realistic levels.
    fn of(effects: &Effects) -> Option<Self> {
        let all: Vec<(EffectKind, f64)> = effects.iter().collect();
        let share = |(kind, size): &(EffectKind, f64)| size / kind.magnitude(Level::Realistic);
        let value = match &all[..] {
            [] => 0.0,
            [(_, size)] => *size,
            [first, rest @ ..] => {
                let is_alike = |other: &(EffectKind, f64)| (share(other) / share(first) - 1.0).abs() < 1e-9;
                rest.iter().all(is_alike).then(|| share(first))?
            }
        };
        Some(Self { kinds: all.into_iter().map(|(kind, _)| kind).collect(), value })
    }
}

impl Lead {
    fn of(sizes: &[f64], errors: &[RobotDifference]) -> Self {
        let end = |of: &dyn Fn(&RobotDifference) -> f64| falls_to_one(sizes, errors.iter().map(of).collect());
        if errors.first().is_none_or(|error| error.difference <= 1.0) {
            return Self::None;
        }
        let Some(size) = end(&|error| error.difference) else { return Self::Remains };
        // Without an interval nothing is known of either end.
        let low = end(&|error| error.interval.map_or(0.0, |interval| interval.low)).unwrap_or(size);
        Self::Ends { size, low, high: end(&|error| error.interval.map_or(f64::INFINITY, |interval| interval.high)) }
    }
}

/// The smallest size at which ratios have fallen to 1; 0 where they begin there.
fn falls_to_one(sizes: &[f64], ratios: Vec<f64>) -> Option<f64> {
    let after = ratios.iter().position(|&ratio| ratio <= 1.0)?;
    let Some(before) = after.checked_sub(1) else { return Some(0.0) };
    let [above, below] = [before, after].map(|place| libm::log(ratios[place]));
    let part = above / (above - below);
    let [from, to] = [sizes[before], sizes[after]];
    Some(if !part.is_finite() {
        to
    } else if from > 0.0 {
        from * libm::pow(to / from, part)
    } else {
        to * part.sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Interval;

    fn errors(of: impl Fn(f64) -> f64, sizes: &[f64]) -> Vec<RobotDifference> {
        let error = |&size: &f64| RobotDifference {
            difference: of(size),
            interval: Some(Interval { low: of(size) / 1.5, high: of(size) * 1.5 }),
            p_adjusted: None,
            better: None,
        };
        sizes.iter().map(error).collect()
    }

    #[test]
    fn analytic_a_power_of_the_size_reaches_one_where_the_law_says() {
        // ρ = 2 (s / 0.1)^-½ is 1 at s = 0.4, 1.5 at 0.4 / 2.25 and 1 / 1.5 at 0.9: ends of the interval.
        let sizes = [0.0, 0.1, 0.35, 0.6, 2.0];
        let law = |s: f64| if s > 0.0 { 2.0 * (s / 0.1).powf(-0.5) } else { 2.2 };
        let Lead::Ends { size, low, high } = Lead::of(&sizes, &errors(law, &sizes)) else { panic!("the lead ends") };
        for (found, expected) in [(size, 0.4), (low, 0.4 / 2.25), (high.unwrap(), 0.9)] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found}, expected {expected}");
        }
        // The upper ends stay above 1 up to 0.6.
        let Lead::Ends { high, .. } = Lead::of(&sizes[..4], &errors(law, &sizes[..4])) else { panic!("the lead ends") };
        assert_eq!(high, None);
    }

    #[test]
    fn analytic_below_the_first_size_the_logarithm_is_linear_in_the_square() {
        // ln ρ = 1 − s² / 4 is 0 at s = 2.
        let sizes = [0.0, 3.0, 4.0];
        let law = |s: f64| (1.0 - s * s / 4.0).exp();
        let Lead::Ends { size, .. } = Lead::of(&sizes, &errors(law, &sizes)) else { panic!("the lead ends") };
        assert!((size - 2.0).abs() < 1e-12, "{size}");
        assert_eq!(Lead::of(&sizes, &errors(|_| 1.2, &sizes)), Lead::Remains);
        assert_eq!(Lead::of(&sizes, &errors(|s| 0.9 + s, &sizes)), Lead::None);
    }

    #[test]
    fn effects_that_grow_together_have_the_share_of_their_levels() {
        let both = |elasticity, hysteresis| {
            let effects = Effects::none().with_effect(EffectKind::Elasticity, elasticity);
            Size::of(&effects.with_effect(EffectKind::Hysteresis, hysteresis))
        };
        let size = both(0.5, 0.075).unwrap();
        assert!((size.value - 0.25).abs() < 1e-12 && size.kinds.len() == 2);
        assert!(both(0.5, 0.1).is_none());
    }
}
