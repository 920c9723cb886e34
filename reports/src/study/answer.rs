//! The answer of a study from its own plan and results: one sentence first, then what limits it.

use armid::study::{Comparison, ConditionResult, Metric, ReportInput};

use super::criteria::{capitalised, criterion_in_words};
use super::selection::shown_estimator;

/// So many effects are named.
const NAMED: usize = 3;

/// Paragraphs of the answer box; none where the study compares nothing.
pub(super) fn answer(input: &ReportInput) -> Vec<String> {
    let mut paragraphs = effects(input);
    paragraphs.extend(criteria(input));
    paragraphs.extend(claims(input));
    paragraphs
}

/// What the criteria achieve, if there are several.
fn criteria(input: &ReportInput) -> Vec<String> {
    let parts = &input.result.conditions;
    let estimator = shown_estimator(input);
    match (&parts[..], &input.result.plan.compare_with[..]) {
        ([only], _) => ranking(only, estimator),
        ([_, ..], [reference]) => over_scenarios(parts, reference, estimator),
        ([first, ..], _) => {
            let mut paragraphs = ranking(first, estimator);
            if let Some(found) = paragraphs.first_mut() {
                *found = format!("In scenario \"{}\": {found}", first.condition.name);
            }
            paragraphs
        }
        ([], _) => Vec::new(),
    }
}

/// The criterion with the smallest torque error, the others relative to it, and the scores that rank them differently.
fn ranking(part: &ConditionResult, estimator: &str) -> Vec<String> {
    let Some(best) = best_family(part, estimator) else { return Vec::new() };
    let of = |metric: Metric| -> Vec<&Comparison> {
        let all = part.findings.comparisons.iter();
        all.filter(|c| c.estimator == estimator && c.metric == metric && [&c.first, &c.second].contains(&&best))
            .collect()
    };
    let against = of(Metric::Prediction);
    if against.is_empty() {
        return Vec::new();
    }
    let name = criterion_in_words(&best);
    let relative = |c: &Comparison| {
        let is_first = c.first == best;
        let value = |x: f64| match (is_first, c.metric.is_logarithmic()) {
            (false, _) => x,
            (true, false) => 1.0 / x,
            (true, true) => -x,
        };
        let interval = c.interval.map_or_else(String::new, |i| {
            let (a, b) = (value(i.low), value(i.high));
            format!(" [{:.2}, {:.2}]", a.min(b), a.max(b))
        });
        let other = criterion_in_words(if is_first { &c.second } else { &c.first });
        format!("{other} {:.2}{interval}", value(c.difference))
    };
    let list = |all: &[&Comparison]| all.iter().map(|c| relative(c)).collect::<Vec<_>>().join(", ");
    let (worse, open): (Vec<&Comparison>, Vec<&Comparison>) = against.iter().partition(|c| c.better.is_some());
    let first = if worse.is_empty() {
        format!(
            "**No difference in torque error is significant.** The smallest error is that of {name} designs; relative to it: {}.",
            list(&open)
        )
    } else {
        let best = capitalised(&name);
        if open.is_empty() {
            format!("**{best} designs predict torque best.** Torque errors relative to theirs: {}.", list(&worse))
        } else {
            format!(
                "**{best} designs have the smallest torque error.** Relative to theirs: {}. Not significantly different: {}.",
                list(&worse),
                list(&open)
            )
        }
    };
    let contrary: Vec<String> = Metric::ALL
        .into_iter()
        .filter(|&metric| metric != Metric::Prediction)
        .filter_map(|metric| {
            let better = of(metric).into_iter().filter(|c| c.better.as_ref().is_some_and(|better| *better != best));
            let better: Vec<&Comparison> = better.collect();
            (!better.is_empty()).then(|| format!("{} ({})", list(&better), metric.title()))
        })
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
    let mut best: Vec<(String, usize)> = Vec::new();
    for family in parts.iter().filter_map(|part| best_family(part, estimator)) {
        match best.iter_mut().find(|(name, _)| *name == family) {
            Some((_, count)) => *count += 1,
            None => best.push((family, 1)),
        }
    }
    best.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let shares: Vec<String> =
        best.iter().map(|(family, count)| format!("{} in {count}", criterion_in_words(family))).collect();
    let all = parts.len();
    let first = match &best[..] {
        [] => return Vec::new(),
        [(only, _)] => format!(
            "**{} designs predict torque best in all {all} scenarios.**",
            capitalised(&criterion_in_words(only))
        ),
        [..] => format!(
            "**No criterion predicts torque best in all {all} scenarios.** The smallest error: {}.",
            shares.join(", ")
        ),
    };
    let scores = [Metric::Prediction, Metric::Measured, Metric::Reference];
    std::iter::once(first).chain(scores.iter().filter_map(|&score| tally(parts, reference, score, estimator))).collect()
}

/// In how many scenarios each criterion is significantly better or worse than one in a score.
fn tally(parts: &[ConditionResult], reference: &str, metric: Metric, estimator: &str) -> Option<String> {
    let mut counts: Vec<(String, [usize; 3])> = Vec::new();
    for part in parts {
        let all = part.findings.comparisons.iter();
        for c in all.filter(|c| c.estimator == estimator && c.metric == metric && c.interval.is_some()) {
            let other = if c.first == reference { &c.second } else { &c.first };
            let place = match &c.better {
                Some(better) if better == other => 0,
                Some(_) => 1,
                None => 2,
            };
            match counts.iter_mut().find(|(name, _)| name == other) {
                Some((_, found)) => found[place] += 1,
                None => {
                    let mut found = [0; 3];
                    found[place] = 1;
                    counts.push((other.clone(), found));
                }
            }
        }
    }
    let words: Vec<String> = counts
        .iter()
        .map(|(family, found)| {
            let words = ["better", "worse", "not significant"].into_iter().zip(found).filter(|(_, count)| **count > 0);
            let words: Vec<String> = words.map(|(word, count)| format!("{word} in {count}")).collect();
            format!("{} {}", criterion_in_words(family), words.join(", "))
        })
        .collect();
    (!words.is_empty()).then(|| {
        format!(
            "{} against {}, number of scenarios: {}.",
            capitalised(metric.title()),
            criterion_in_words(reference),
            words.join("; ")
        )
    })
}

fn best_family(part: &ConditionResult, estimator: &str) -> Option<String> {
    let scores = part.findings.families.iter().filter(|score| score.estimator == estimator);
    let valued = scores.filter_map(|score| Some((score.values.first().copied().flatten()?, &score.family)));
    valued.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, family)| family.clone())
}

/// The effects that raise the error most, criterion by criterion; none if the plan compares criteria with one of them.
fn effects(input: &ReportInput) -> Vec<String> {
    let (plan, Some(sensitivity)) = (&input.result.plan, input.result.effect_sensitivity.as_ref()) else {
        return Vec::new();
    };
    if !plan.compare_with.is_empty() && plan.designs.len() > 1 {
        return Vec::new();
    }
    let estimator = shown_estimator(input);
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
        let small = found.iter().filter(|(_, ratio)| *ratio < 1.1).count();
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
fn claims(input: &ReportInput) -> Option<String> {
    let found = input.result.radkhah2007.as_ref()?;
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for claim in &found.claims {
        let words = claim.verdict.words();
        match counts.iter_mut().find(|(verdict, _)| *verdict == words) {
            Some((_, count)) => *count += 1,
            None => counts.push((words, 1)),
        }
    }
    let listed: Vec<String> = counts.iter().map(|(verdict, count)| format!("{verdict}: {count}")).collect();
    Some(format!("**{} claims of Radkhah et al. (2007).** {}.", found.claims.len(), listed.join(", ")))
}
