//! The answer of a study from its own plan and results: one sentence first, then what limits it.

use super::comparison::Comparison;
use super::condition::ConditionResult;
use super::criterion_words::{capitalised, criterion_in_words};
use super::metric::Metric;
use super::ranking::{Ranking, Tally, known_or_new, tallies, wins};
use super::result::StudyResult;

/// So many effects are named.
const NAMED: usize = 3;

/// An increase of the error below this ratio is called small.
const SMALL: f64 = 1.1;

/// The scores that are counted over scenarios.
const COUNTED: [Metric; 3] = [Metric::Prediction, Metric::Measured, Metric::Reference];

impl StudyResult {
    /// The answer in paragraphs, what was found in bold (`**`); none where the study compares nothing.
    pub fn answer(&self) -> Vec<String> {
        let mut paragraphs = self.effects();
        paragraphs.extend(criteria(&self.conditions, &self.plan.compare_with, self.shown_estimator()));
        paragraphs.extend(self.claims());
        paragraphs
    }

    /// The effects that raise the error most, criterion by criterion; none if the plan compares criteria with one of them.
    fn effects(&self) -> Vec<String> {
        let (plan, Some(sensitivity)) = (&self.plan, self.effect_sensitivity.as_ref()) else { return Vec::new() };
        if !plan.compare_with.is_empty() && plan.designs.len() > 1 {
            return Vec::new();
        }
        let estimator = self.shown_estimator();
        let of_family = |family: &str| {
            let mut found: Vec<(&str, f64)> = sensitivity
                .entries
                .iter()
                .filter(|entry| entry.estimator == estimator && entry.family == family)
                .filter_map(|entry| Some((entry.condition.as_str(), entry.prediction_ratio?)))
                .collect();
            found.sort_by(|(_, a), (_, b)| b.total_cmp(a));
            let named: Vec<String> =
                found.iter().take(NAMED).map(|(name, ratio)| format!("{name} ({ratio:.0} times)")).collect();
            let small = found.iter().filter(|(_, ratio)| *ratio < SMALL).count();
            let with = if plan.designs.len() > 1 {
                format!(" with {} designs", criterion_in_words(family))
            } else {
                String::new()
            };
            (!named.is_empty()).then(|| {
                format!(
                    "**The torque error grows most under {}{with}.** In {small} of {} scenarios it grows by less than a tenth.",
                    named.join(", "),
                    found.len()
                )
            })
        };
        plan.designs.iter().filter_map(|design| of_family(&design.name)).collect()
    }

    /// How many claims of the source paper hold, by verdict.
    fn claims(&self) -> Option<String> {
        let found = self.radkhah2007.as_ref()?;
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for claim in &found.claims {
            let words = claim.verdict.words();
            known_or_new(&mut counts, |(verdict, _)| *verdict == words, || (words, 0)).1 += 1;
        }
        let listed: Vec<String> = counts.iter().map(|(verdict, count)| format!("{verdict}: {count}")).collect();
        Some(format!("**{} claims of Radkhah et al. (2007).** {}.", found.claims.len(), listed.join(", ")))
    }
}

/// What the criteria achieve, if there are several.
fn criteria(parts: &[ConditionResult], compare_with: &[String], estimator: &str) -> Vec<String> {
    let of = |part: &ConditionResult| part.ranking(estimator).map_or_else(Vec::new, |ranking| ranked(&ranking));
    match (parts, compare_with) {
        ([only], _) => of(only),
        ([_, ..], [reference]) => over_scenarios(parts, reference, estimator),
        ([first, ..], _) => {
            let mut paragraphs = of(first);
            if let Some(found) = paragraphs.first_mut() {
                *found = format!("In scenario \"{}\": {found}", first.condition.name);
            }
            paragraphs
        }
        ([], _) => Vec::new(),
    }
}

/// The criterion with the smallest torque error, the others relative to it, and the scores that rank them differently.
fn ranked(ranking: &Ranking) -> Vec<String> {
    let name = criterion_in_words(&ranking.best);
    let relative = |c: &&Comparison| {
        let interval = c.interval.map_or_else(String::new, |i| format!(" [{:.2}, {:.2}]", i.low, i.high));
        format!("{} {:.2}{interval}", criterion_in_words(&c.first), c.difference)
    };
    let list = |all: &[&Comparison]| all.iter().map(relative).collect::<Vec<_>>().join(", ");
    let others = |is_one: &dyn Fn(&str) -> bool| -> Vec<&Comparison> {
        ranking.others.iter().filter(|c| c.better.as_deref().is_some_and(is_one)).collect()
    };
    // Means are of all designs, the test may be of pairs alone: the two can disagree.
    let (worse, better) = (others(&|family| family == ranking.best), others(&|family| family != ranking.best));
    let open: Vec<&Comparison> = ranking.others.iter().filter(|c| c.better.is_none()).collect();
    let best = capitalised(&name);
    let mut first = match (&worse[..], &open[..]) {
        _ if !better.is_empty() => format!(
            "**Mean and paired test disagree.** {best} designs have the smallest mean torque error. In pairs, others are significantly better: {}.",
            list(&better)
        ),
        ([], open) => format!(
            "**No difference in torque error is significant.** The smallest error is that of {name} designs; relative to it: {}.",
            list(open)
        ),
        (worse, []) => {
            format!("**{best} designs predict torque best.** Torque errors relative to theirs: {}.", list(worse))
        }
        (worse, _) => {
            format!("**{best} designs have the smallest torque error.** Relative to theirs: {}.", list(worse))
        }
    };
    if !better.is_empty() && !worse.is_empty() {
        first.push_str(&format!(" Significantly worse: {}.", list(&worse)));
    }
    if !(open.is_empty() || better.is_empty() && worse.is_empty()) {
        first.push_str(&format!(" Not significantly different: {}.", list(&open)));
    }
    let contrary: Vec<String> = ranking
        .contrary
        .iter()
        .map(|(metric, better)| format!("{} ({})", list(&better.iter().collect::<Vec<_>>()), metric.title()))
        .collect();
    let second = if contrary.is_empty() {
        "In no other score are other designs significantly better.".to_owned()
    } else {
        format!("Significantly better than {name} designs in other scores: {}.", contrary.join("; "))
    };
    vec![first, second]
}

/// How often each criterion is better and worse than one, over all scenarios.
fn over_scenarios(parts: &[ConditionResult], reference: &str, estimator: &str) -> Vec<String> {
    let (wins, all) = (wins(parts, estimator), parts.len());
    let first = match &wins[..] {
        [] => return Vec::new(),
        [(only, _)] => format!(
            "**{} designs have the smallest torque error in all {all} scenarios.**",
            capitalised(&criterion_in_words(only))
        ),
        [..] => {
            let shares = wins.iter().map(|(family, count)| format!("{} in {count}", criterion_in_words(family)));
            format!(
                "**No criterion has the smallest torque error in all {all} scenarios.** It is that of {}.",
                shares.collect::<Vec<_>>().join(", ")
            )
        }
    };
    let counted =
        COUNTED.iter().filter_map(|&score| counts(&tallies(parts, reference, score, estimator), reference, score));
    std::iter::once(first).chain(counted).collect()
}

/// In how many scenarios each criterion is significantly better or worse than one in a score; `None` of no criterion.
fn counts(tallies: &[Tally], reference: &str, metric: Metric) -> Option<String> {
    let words = |tally: &Tally| {
        let counts = [("better", tally.better), ("worse", tally.worse), ("not significant", tally.open)];
        let counts = counts.iter().filter(|(_, count)| *count > 0).map(|(word, count)| format!("{word} in {count}"));
        format!("{} {}", criterion_in_words(&tally.family), counts.collect::<Vec<_>>().join(", "))
    };
    (!tallies.is_empty()).then(|| {
        format!(
            "{} against {}, number of scenarios: {}.",
            capitalised(metric.title()),
            criterion_in_words(reference),
            tallies.iter().map(words).collect::<Vec<_>>().join("; ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::radkhah2007::{Claim, Reproduction, Verdict};
    use crate::study::small_results::{ESTIMATOR, compared, scenario, score, study};
    use crate::study::{EffectSensitivity, FamilyScore, SensitivityEntry};

    const PREDICTION: Metric = Metric::Prediction;

    /// The answer of one scenario in which "condition" and "d-optimal" were compared, in this order.
    fn of_two(errors: [f64; 2], comparisons: Vec<Comparison>) -> Vec<String> {
        let families = vec![score("condition", Some(errors[0])), score("d-optimal", Some(errors[1]))];
        study(vec![scenario("only", families, comparisons)], &[]).answer()
    }

    const PAIR: [&str; 2] = ["condition", "d-optimal"];

    #[test]
    fn analytic_the_best_criterion_is_named_whichever_side_it_was_compared_on() {
        // Second over first 2 [1.6, 2.5] is first over second 0.5 [0.4, 0.625].
        let second = of_two([2.0, 1.0], vec![compared(PREDICTION, PAIR, [1.6, 2.0, 2.5], Some(1))]);
        assert_eq!(
            second,
            [
                "**D-optimal designs predict torque best.** Torque errors relative to theirs: condition number 2.00 [1.60, 2.50].",
                "In no other score are other designs significantly better."
            ]
        );
        let first = of_two([1.0, 2.0], vec![compared(PREDICTION, PAIR, [0.4, 0.5, 0.625], Some(0))]);
        assert_eq!(
            first[0],
            "**Condition number designs predict torque best.** Torque errors relative to theirs: D-optimal 2.00 [1.60, 2.50]."
        );
        let open = of_two([1.0, 2.0], vec![compared(PREDICTION, PAIR, [0.25, 0.5, 1.25], None)]);
        assert_eq!(
            open[0],
            "**No difference in torque error is significant.** The smallest error is that of condition number designs; relative to it: D-optimal 2.00 [0.80, 4.00]."
        );
    }

    #[test]
    fn analytic_a_criterion_that_is_better_in_pairs_is_not_called_worse() {
        // The condition number has the smaller mean of all designs; of those that share their start it has the larger error.
        let pair = compared(PREDICTION, PAIR, [1.25, 2.0, 2.5], Some(1));
        let told = of_two([1.0, 1.1], vec![pair.clone()]).remove(0);
        let disagree = "**Mean and paired test disagree.** Condition number designs have the smallest mean torque error. In pairs, others are significantly better: D-optimal 0.50 [0.40, 0.80].";
        assert_eq!(told, disagree);
        let third = |pair, better| compared(PREDICTION, pair, [0.25, 0.5, 0.75], better);
        let families = ["condition", "d-optimal", "random", "table-one"].map(|name| score(name, Some(1.0))).to_vec();
        let comparisons = vec![pair, third(["condition", "random"], Some(0)), third(["condition", "table-one"], None)];
        let told = study(vec![scenario("only", families, comparisons)], &[]).answer().remove(0);
        let others =
            " Significantly worse: random 2.00 [1.33, 4.00]. Not significantly different: table-one 2.00 [1.33, 4.00].";
        assert_eq!(told, format!("{disagree}{others}"));
    }

    #[test]
    fn analytic_scores_that_rank_differently_are_told_relative_to_the_best() {
        let comparisons = |metric, better| {
            vec![
                compared(PREDICTION, PAIR, [0.4, 0.5, 0.625], Some(0)),
                compared(metric, PAIR, [0.5, 2.0, 4.0], better),
                Comparison { estimator: "ols".to_owned(), ..compared(Metric::Si, PAIR, [2.0, 3.0, 4.0], Some(1)) },
            ]
        };
        let told = |metric, better| of_two([1.0, 2.0], comparisons(metric, better)).remove(1);
        // A log volume is compared by its difference: its sign turns.
        assert_eq!(
            told(Metric::LogVolume, Some(1)),
            "Significantly better than condition number designs in other scores: D-optimal -2.00 [-4.00, -0.50] (log volume of the error, reference units)."
        );
        assert_eq!(
            told(Metric::Reference, Some(1)),
            "Significantly better than condition number designs in other scores: D-optimal 0.50 [0.25, 2.00] (parameter RMSE, reference units)."
        );
        for better in [None, Some(0)] {
            assert_eq!(told(Metric::Reference, better), "In no other score are other designs significantly better.");
        }
    }

    #[test]
    fn analytic_of_three_criteria_only_the_significant_ones_are_worse() {
        let three = |random| {
            vec![
                score("condition", Some(3.0)),
                score("d-optimal", Some(1.0)),
                score("random", random),
                FamilyScore { estimator: "ols".to_owned(), ..score("table-one", Some(0.1)) },
            ]
        };
        let others = vec![
            compared(PREDICTION, PAIR, [2.0, 3.0, 4.0], Some(1)),
            compared(PREDICTION, ["condition", "random"], [0.5, 1.0, 2.0], None),
            compared(PREDICTION, ["d-optimal", "random"], [0.25, 0.5, 1.25], None),
        ];
        let of = |random| study(vec![scenario("only", three(random), others.clone())], &[]).answer();
        let words = "**D-optimal designs have the smallest torque error.** Relative to theirs: condition number 3.00 [2.00, 4.00]. Not significantly different: random 2.00 [0.80, 4.00].";
        // The first of equal ones; one without a value is not ranked.
        for random in [Some(2.0), Some(1.0), None] {
            assert_eq!(of(random)[0], words);
        }
        assert!(of(Some(0.5))[0].starts_with(
            "**No difference in torque error is significant.** The smallest error is that of random designs"
        ));
        // Without a comparison nothing is said of the best, and without scenarios nothing at all.
        assert!(study(vec![scenario("only", three(None), Vec::new())], &[]).answer().is_empty());
        assert!(criteria(&[], &[], ESTIMATOR).is_empty());
    }

    #[test]
    fn analytic_wins_and_tallies_are_counted_over_scenarios() {
        let part = |name: &str, errors: [f64; 2], comparison: Comparison| {
            let families = vec![score("condition", Some(errors[0])), score("d-optimal", Some(errors[1]))];
            scenario(name, families, vec![comparison])
        };
        let turned = ["d-optimal", "condition"];
        let parts = vec![
            part("one", [1.0, 2.0], compared(PREDICTION, PAIR, [0.4, 0.5, 0.6], Some(0))),
            part("two", [2.0, 1.0], compared(PREDICTION, PAIR, [1.5, 2.0, 2.5], Some(1))),
            part("three", [2.0, 1.0], compared(PREDICTION, turned, [0.4, 0.5, 0.6], Some(0))),
            part("four", [1.0, 2.0], compared(PREDICTION, turned, [0.4, 2.0, 2.5], None)),
            part("five", [2.0, 1.0], compared(Metric::Reference, turned, [0.4, 0.5, 0.6], Some(1))),
            part("six", [2.0, 1.0], Comparison { interval: None, ..compared(PREDICTION, PAIR, [2.0; 3], None) }),
        ];
        let answer = study(parts.clone(), &["d-optimal"]).answer();
        assert_eq!(
            answer,
            [
                "**No criterion has the smallest torque error in all 6 scenarios.** It is that of D-optimal in 4, condition number in 2.",
                "Torque prediction RMSE, N·m against D-optimal, number of scenarios: condition number better in 1, worse in 2, not significant in 1.",
                "Parameter RMSE, reference units against D-optimal, number of scenarios: condition number better in 1.",
            ]
        );
        // Of all pairs the first scenario alone is told, by its name.
        let first = study(parts.clone(), &[]).answer();
        assert!(
            first[0].starts_with("In scenario \"one\": **Condition number designs predict torque best.**"),
            "{first:?}"
        );
        let won = study(vec![parts[1].clone(), parts[2].clone()], &["d-optimal"]).answer();
        assert_eq!(won[0], "**D-optimal designs have the smallest torque error in all 2 scenarios.**");
        // Equal counts stand in the order in which they were won.
        let equal = study(vec![parts[1].clone(), parts[0].clone()], &["d-optimal"]).answer();
        assert!(equal[0].ends_with("It is that of D-optimal in 1, condition number in 1."), "{equal:?}");
    }

    #[test]
    fn analytic_effects_are_named_by_the_error_that_they_cause_and_claims_counted() {
        let entry = |condition: &str, ratio| SensitivityEntry {
            condition: condition.to_owned(),
            effect: None,
            level: None,
            meaning: String::new(),
            family: "condition".to_owned(),
            estimator: ESTIMATOR.to_owned(),
            runs: 1,
            failures: 0,
            prediction_nm: None,
            prediction_ratio: ratio,
            prediction_interval: None,
            kind_ratios: Vec::new(),
            parameters: Vec::new(),
            worst: Vec::new(),
        };
        let mut result = study(vec![scenario("exact", vec![score("condition", Some(1.0))], Vec::new())], &[]);
        let entries =
            [("slight", Some(1.0)), ("tool", Some(2.4)), ("none", None), ("load", Some(30.6)), ("warm", Some(1.1))];
        let mut entries: Vec<_> = entries.into_iter().map(|(name, ratio)| entry(name, ratio)).collect();
        entries.push(SensitivityEntry { estimator: "ols".to_owned(), ..entry("other", Some(99.0)) });
        result.effect_sensitivity = Some(EffectSensitivity { kinds: Vec::new(), entries });
        let claim = |verdict| Claim { claim: String::new(), verdict, rule: String::new(), quantities: Vec::new() };
        let claims = [Verdict::Holds, Verdict::Undecided, Verdict::Holds].map(claim).to_vec();
        result.radkhah2007 = Some(Reproduction { claims, table: Vec::new() });
        let told = "**The torque error grows most under load (31 times), tool (2 times), warm (1 times) with condition number designs.** In 1 of 4 scenarios it grows by less than a tenth.";
        let counted = "**3 claims of Radkhah et al. (2007).** holds: 2, undecided: 1.";
        assert_eq!(result.answer(), [told, counted]);
        result.plan.compare_with = vec!["condition".to_owned()];
        assert_eq!(result.answer(), [counted]);
        result.plan.designs.truncate(1);
        assert_eq!(result.answer(), [told.replace(" with condition number designs", "").as_str(), counted]);
    }
}
