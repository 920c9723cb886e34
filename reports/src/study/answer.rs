//! The answer of a study, from its own plan and results: one sentence first, then the details that limit it.

use armid::study::{Comparison, ConditionResult, Metric, ReportInput};

use super::overview::sentence;
use super::selection::shown_estimator;

/// So many effects are named.
const NAMED: usize = 3;

/// Paragraphs of the answer box; none where the study compares nothing.
pub(super) fn answer(input: &ReportInput) -> Vec<String> {
    let mut paragraphs = effects(input);
    paragraphs.extend(families(input));
    paragraphs.extend(claims(input));
    paragraphs
}

/// What families of designs achieve, where there are several.
fn families(input: &ReportInput) -> Vec<String> {
    let parts = &input.result.conditions;
    let estimator = shown_estimator(input);
    match (&parts[..], &input.result.plan.compare_with[..]) {
        ([only], _) => ranking(only, estimator),
        ([_, ..], [reference]) => over_conditions(parts, reference, estimator),
        ([first, ..], _) => {
            let mut paragraphs = ranking(first, estimator);
            if let Some(found) = paragraphs.first_mut() {
                *found = format!("Under condition \"{}\": {found}", first.condition.name);
            }
            paragraphs
        }
        ([], _) => Vec::new(),
    }
}

/// The family with the smallest error, and the others against it.
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
    let (decided, undecided): (Vec<&Comparison>, Vec<&Comparison>) = against.iter().partition(|c| c.better.is_some());
    let ratio = |c: &Comparison| {
        let other = if c.first == best { &c.second } else { &c.first };
        let value = |x: f64| if c.first == best { 1.0 / x } else { x };
        let interval = c.interval.map_or_else(String::new, |i| {
            let (a, b) = (value(i.low), value(i.high));
            format!(" [{:.2}, {:.2}]", a.min(b), a.max(b))
        });
        format!("{other} {:.2}{interval}", value(c.difference))
    };
    let list = |all: &[&Comparison]| all.iter().map(|c| ratio(c)).collect::<Vec<_>>().join(", ");
    let mut first = format!("**{best} predicts torque best**; error of the others over its own: {}.", list(&decided));
    if decided.is_empty() {
        first = format!(
            "**{best} has the smallest torque prediction error, and none of the others is shown to be worse.**"
        );
    }
    if !undecided.is_empty() {
        first += &format!(" Undecided: {}.", list(&undecided));
    }
    let mut paragraphs = vec![first];
    let others: Vec<Metric> = Metric::ALL.into_iter().filter(|&metric| metric != Metric::Prediction).collect();
    let contrary: Vec<String> = others
        .iter()
        .flat_map(|&metric| of(metric))
        .filter(|c| c.better.as_ref().is_some_and(|better| *better != best))
        .map(sentence)
        .collect();
    paragraphs.push(if contrary.is_empty() {
        "No other metric shows a family that is better than it.".to_owned()
    } else {
        format!("The metrics disagree. {}", contrary.join(" "))
    });
    paragraphs
}

/// How often each family is better and worse than one, over all conditions.
fn over_conditions(parts: &[ConditionResult], reference: &str, estimator: &str) -> Vec<String> {
    let mut best: Vec<(String, usize)> = Vec::new();
    for family in parts.iter().filter_map(|part| best_family(part, estimator)) {
        match best.iter_mut().find(|(name, _)| *name == family) {
            Some((_, count)) => *count += 1,
            None => best.push((family, 1)),
        }
    }
    best.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    if best.is_empty() {
        return Vec::new();
    }
    let shares: Vec<String> = best.iter().map(|(family, count)| format!("{family} under {count}")).collect();
    let mut paragraphs = vec![format!(
        "**No family is best under all of the {} conditions**; the smallest torque prediction error has {}.",
        parts.len(),
        shares.join(", ")
    )];
    if let [(only, _)] = &best[..] {
        paragraphs[0] =
            format!("**{only} has the smallest torque prediction error under all {} conditions.**", parts.len());
    }
    for metric in [Metric::Prediction, Metric::Measured, Metric::Reference] {
        paragraphs.extend(tally(parts, reference, metric, estimator));
    }
    paragraphs
}

/// Under how many conditions each family is better or worse than one by a metric.
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
        .map(|(family, [better, worse, open])| {
            format!("{family} better under {better}, worse under {worse}, undecided under {open}")
        })
        .collect();
    (!words.is_empty()).then(|| format!("Against {reference}, by {}: {}.", metric.title(), words.join("; ")))
}

fn best_family(part: &ConditionResult, estimator: &str) -> Option<String> {
    let scores = part.findings.families.iter().filter(|score| score.estimator == estimator);
    let valued = scores.filter_map(|score| Some((score.values.first().copied().flatten()?, &score.family)));
    valued.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, family)| family.clone())
}

/// The effects that raise the error most, family by family; none where families are compared with one under every condition.
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
        let with = if plan.designs.len() > 1 { format!(" with {family}") } else { String::new() };
        (!named.is_empty()).then(|| {
            format!(
                "**The torque prediction error grows most under {}{with}.** Under {small} of {} conditions it grows by less \
                 than a tenth.",
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
    Some(format!("**Of {} claims of Radkhah et al. (2007)** – {}.", found.claims.len(), listed.join(", ")))
}
