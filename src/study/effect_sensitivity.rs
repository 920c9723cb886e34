//! Sensitivity of each estimate to each effect of the real arm: bias of every parameter, error of every kind of parameter, error
//! of prediction.
//!
//! ```text
//! bias          mean over runs of β̂ − β, over the mean standard deviation that the estimator states, and in reference units
//! error ratio   √ mean_i (RMSE_i / RMSE⁰_i)²     over the parameters i of one kind, RMSE⁰ without the effect
//! prediction    geometric mean over runs of RMSE / RMSE⁰, torques over their ratings, runs in pairs: same design, run,
//!               random numbers; interval by Student's t on its logarithm (designs as units where there are at least two)
//! ```
//! The true β are those of the arm without the effect: what an identification without the effect in its model should
//! have found.

use std::collections::BTreeMap;

use super::condition::ConditionResult;
use super::design::StudyDesign;
use super::error::StudyError;
use super::evidence::present;
use super::family_score::{FamilyScore, ParameterScore};
use super::metric::Metric;
use super::run_table::{RunNumber, RunTable};
use super::setup::StudySetup;
use crate::experiment::Level;
use crate::model::{ParameterKind, distinct};
use crate::statistics::{Interval, mean, t_interval};

/// The sensitivity of the estimates to all effects of a study.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EffectSensitivity {
    /// The kinds of parameters that error ratios are given for.
    pub kinds: Vec<String>,
    /// One entry per condition with effects, family and estimator.
    pub entries: Vec<SensitivityEntry>,
}

/// The sensitivity to one condition of one family of designs with one estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SensitivityEntry {
    /// Name of the condition.
    pub condition: String,
    /// Name of the effect, where there is one alone.
    pub effect: Option<String>,
    /// Its level, where its magnitude is one.
    pub level: Option<Level>,
    /// Magnitude with unit, and what it means.
    pub meaning: String,
    /// Name of the family.
    pub family: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Runs that gave an estimate.
    pub runs: usize,
    /// Runs that did not.
    pub failures: usize,
    /// Torque prediction RMSE, geometric mean over runs, N·m; `None` without runs.
    pub prediction_nm: Option<f64>,
    /// Prediction error over that without the effect.
    pub prediction_ratio: Option<f64>,
    /// Its 95 % interval.
    pub prediction_interval: Option<Interval>,
    /// Error ratio of each kind of parameter, in the order of [`EffectSensitivity::kinds`]; `None` where the base has none.
    pub kind_ratios: Vec<Option<f64>>,
    /// One entry per base parameter.
    pub parameters: Vec<ParameterBias>,
    /// Indices of the base parameters, those with the largest bias over its standard deviation first.
    pub worst: Vec<usize>,
}

/// Bias of one base parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ParameterBias {
    /// Over the standard deviation that the estimator states.
    pub in_std: f64,
    /// Its 95 % interval.
    pub in_std_interval: Option<Interval>,
    /// In the declared reference unit.
    pub in_units: f64,
    /// Its 95 % interval.
    pub in_units_interval: Option<Interval>,
}

/// A kind of parameter in words.
fn kind_name(kind: ParameterKind) -> &'static str {
    match kind {
        ParameterKind::M => "masses",
        ParameterKind::Mcx | ParameterKind::Mcy | ParameterKind::Mcz => "first moments",
        ParameterKind::Term(term) => term.entry().group,
        _ => "inertias",
    }
}

fn scaled(interval: Option<Interval>, unit: f64) -> Option<Interval> {
    interval.map(|i| Interval { low: i.low / unit, high: i.high / unit })
}

impl ParameterBias {
    fn of(score: &ParameterScore, unit: f64) -> Self {
        Self {
            in_std: score.bias / score.stated_std,
            in_std_interval: scaled(score.bias_interval, score.stated_std),
            in_units: score.bias / unit,
            in_units_interval: scaled(score.bias_interval, unit),
        }
    }
}

impl StudySetup {
    /// The effect sensitivity of a study whose first condition has no effects and some other has; `None` of another.
    ///
    /// # Errors
    /// [`StudyError::Runs`] where the numbers of the runs cannot be read.
    pub fn effect_sensitivity(
        &self,
        designs: &[StudyDesign],
        conditions: &[ConditionResult],
        runs: &dyn RunTable,
    ) -> Result<Option<EffectSensitivity>, StudyError> {
        let Some(first) = conditions.first().filter(|first| first.condition.effects.is_none()) else { return Ok(None) };
        let kinds = self.kinds();
        let names: Vec<&'static str> = distinct(kinds.iter().copied());
        let mut entries = Vec::new();
        for (index, result) in conditions.iter().enumerate() {
            if result.condition.effects.is_none() || result.condition.engine != first.condition.engine {
                continue;
            }
            for (score, plain) in result.findings.families.iter().zip(&first.findings.families) {
                let pairs = self.pairs(designs, runs, index, score)?;
                entries.push(self.entry(result, score, plain, &pairs, (&names, &kinds)));
            }
        }
        let kinds = names.into_iter().map(str::to_owned).collect();
        Ok((!entries.is_empty()).then_some(EffectSensitivity { kinds, entries }))
    }

    /// The kind of each base parameter, in words.
    fn kinds(&self) -> Vec<&'static str> {
        self.base.kept.iter().map(|&column| kind_name(self.base.parameters[column].kind)).collect()
    }

    /// Logarithms of prediction error under a condition over that under the first, by design; the mean of runs that share noise.
    fn pairs(
        &self,
        designs: &[StudyDesign],
        runs: &dyn RunTable,
        condition: usize,
        score: &FamilyScore,
    ) -> Result<BTreeMap<usize, Vec<f64>>, StudyError> {
        let mut pairs: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        let Some(estimator) = self.plan.identification.estimators.iter().position(|name| *name == score.estimator)
        else {
            return Ok(pairs);
        };
        let of_family = |design: &StudyDesign| self.plan.designs[design.family].name == score.family;
        let number = RunNumber::Metric { estimator, metric: Metric::PredictionOfRating };
        for (index, _) in designs.iter().enumerate().filter(|(_, design)| of_family(design)) {
            let [without, with] =
                [0, condition].map(|condition| runs.numbers(index, condition, 0..runs.runs(index, condition), number));
            let both = without?.into_iter().zip(with?).map(|(without, with)| Some(libm::log(with? / without?)));
            // Runs that share their noise are one unit.
            for group in both.collect::<Vec<_>>().chunks(self.plan.runs_of_noise()) {
                let logs = present(group);
                if !logs.is_empty() {
                    pairs.entry(index).or_default().push(mean(&logs));
                }
            }
        }
        Ok(pairs)
    }

    fn entry(
        &self,
        result: &ConditionResult,
        score: &FamilyScore,
        plain: &FamilyScore,
        pairs: &BTreeMap<usize, Vec<f64>>,
        (names, kinds): (&[&'static str], &[&'static str]),
    ) -> SensitivityEntry {
        let effects = &result.condition.effects;
        let mut alone = effects.iter();
        let only = match (alone.next(), alone.next()) {
            (Some(one), None) => Some(one),
            _ => None,
        };
        let meaning = effects.iter().map(|(kind, magnitude)| {
            let entry = kind.entry();
            format!("{magnitude} {}: {}", entry.unit, entry.meaning).replace(" : ", ": ")
        });
        let means: Vec<f64> = pairs.values().map(|logs| mean(logs)).collect();
        let pooled: Vec<f64> = pairs.values().flatten().copied().collect();
        let units = if means.len() > 1 { &means } else { &pooled };
        let ratio = (!pooled.is_empty()).then(|| libm::exp(mean(&pooled)));
        let interval = t_interval(units, 0.95).map(Interval::exponentiated);
        let scored = if score.runs > 0 { &score.parameters[..] } else { &[] };
        let kind_ratios = names.iter().map(|name| {
            let squares: Vec<f64> = kinds
                .iter()
                .zip(scored.iter().zip(&plain.parameters))
                .filter(|(kind, _)| *kind == name)
                .map(|(_, (with, without))| (with.rmse / without.rmse).powi(2))
                .collect();
            (!squares.is_empty()).then(|| mean(&squares).sqrt())
        });
        let parameters: Vec<ParameterBias> =
            scored.iter().zip(&self.scorer.units).map(|(p, &unit)| ParameterBias::of(p, unit)).collect();
        let mut worst: Vec<usize> = (0..parameters.len()).collect();
        worst.sort_by(|&a, &b| parameters[b].in_std.abs().total_cmp(&parameters[a].in_std.abs()));
        SensitivityEntry {
            condition: result.condition.name.clone(),
            effect: only.map(|(kind, _)| kind.name().to_owned()),
            level: only.and_then(|(kind, magnitude)| kind.level(magnitude)),
            meaning: meaning.collect::<Vec<_>>().join("; "),
            family: score.family.clone(),
            estimator: score.estimator.clone(),
            runs: score.runs,
            failures: score.failures,
            prediction_nm: score.values.first().copied().flatten(),
            prediction_ratio: ratio,
            prediction_interval: interval,
            kind_ratios: kind_ratios.collect(),
            parameters,
            worst,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Unobserved;
    use crate::study::run_id::RunId;
    use crate::study::small_results::{ESTIMATOR, erring, scenario, score, setup};
    use crate::study::{Outcome, OutcomeTable, Score, ScoredEstimate};

    #[test]
    fn analytic_pairs_are_logarithms_of_error_with_over_error_without() {
        let setup = setup();
        let table_one = setup.plan.designs.len() - 1;
        let design = setup.designs_of_sequence(table_one, 0, &Unobserved).unwrap().pop().unwrap();
        let designs = [StudyDesign { family: 0, ..design.clone() }, design];
        let place = setup.plan.identification.estimators.iter().position(|name| name == ESTIMATOR).unwrap();
        let outcome = |RunId { design, condition, run }: RunId, error: Option<f64>| {
            let estimate = |error: f64| ScoredEstimate {
                score: Some(Score { prediction_rmse_of_rating: error, ..erring(f64::NAN) }),
                ..ScoredEstimate::failed(ESTIMATOR, crate::study::RunError::estimator(&""))
            };
            let estimates = error.map_or_else(Vec::new, |error| vec![estimate(error); place + 1]);
            Outcome { design, condition, truth: 0, run, failure: None, estimates }
        };
        // Of the second design 2, 6 without and 8, none with: one pair. The first has 3 and 1.
        let errors = [[[Some(3.0), None], [Some(1.0), None]], [[Some(2.0), Some(6.0)], [Some(8.0), None]]];
        let mut outcomes = Vec::new();
        for (design, of_design) in errors.iter().enumerate() {
            for (condition, runs) in of_design.iter().enumerate() {
                for (run, &error) in runs.iter().enumerate() {
                    outcomes.push(outcome(RunId { design, condition, run: run as u64 }, error));
                }
            }
        }
        let runs = OutcomeTable { outcomes: &outcomes, truths: &[] };
        for (family, index, expected) in [(0, 0, libm::log(1.0 / 3.0)), (table_one, 1, libm::log(4.0))] {
            let score = score(&setup.plan.designs[family].name, Some(1.0));
            let pairs = setup.pairs(&designs, &runs, 1, &score).unwrap();
            assert_eq!(pairs, BTreeMap::from([(index, vec![expected])]));
        }
        let unknown = FamilyScore { estimator: "another".to_owned(), ..score("d-optimal", None) };
        assert!(setup.pairs(&designs, &runs, 1, &unknown).unwrap().is_empty());
    }

    #[test]
    fn analytic_a_family_without_a_run_has_neither_biases_nor_ratios() {
        let setup = setup();
        let (rank, kinds) = (setup.base.rank(), setup.kinds());
        let parameter = |rmse: f64| ParameterScore {
            bias: 0.5,
            bias_interval: None,
            std: None,
            stated_std: 0.25,
            bound_std: 1.0,
            rmse,
            coverage: 0.0,
            coverage_interval: None,
            spread: None,
        };
        let scored = |runs: usize, rmse: f64| FamilyScore {
            runs,
            parameters: vec![parameter(rmse); rank],
            ..score("d-optimal", None)
        };
        let warm = scenario("warm", Vec::new(), Vec::new());
        let of = |runs: usize| {
            let pairs = BTreeMap::new();
            setup.entry(&warm, &scored(runs, 6.0), &scored(1, 2.0), &pairs, (&kinds[..1], &kinds))
        };
        let (one, none) = (of(1), of(0));
        assert_eq!((one.parameters.len(), one.worst.len(), one.kind_ratios), (rank, rank, vec![Some(3.0)]));
        assert_eq!(one.parameters[0].in_std, 2.0);
        assert_eq!((none.parameters.len(), none.worst.len(), none.kind_ratios), (0, 0, vec![None]));
    }
}
