//! Which criterion has the smallest error: in one scenario, and how often over all of them.

use super::comparison::Comparison;
use super::condition::ConditionResult;
use super::metric::Metric;

/// The criteria of one scenario by their torque error.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// The family with the smallest geometric mean.
    pub best: String,
    /// Torque error of each family that it was compared with over its own. One of them may be significantly better: the comparison is of pairs
    /// where designs share their start, the mean of all designs.
    pub others: Vec<Comparison>,
    /// Scores in which families are significantly better than it, each over its own score.
    pub contrary: Vec<(Metric, Vec<Comparison>)>,
}

/// In how many scenarios one family is better than another in a score.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// The family.
    pub family: String,
    /// Scenarios in which it is significantly better.
    pub better: usize,
    /// Scenarios in which it is significantly worse.
    pub worse: usize,
    /// Scenarios in which neither is.
    pub open: usize,
}

impl ConditionResult {
    /// The family with the smallest torque error; the first of equal ones, `None` where none has a value.
    pub fn best_family(&self, estimator: &str) -> Option<&str> {
        let scores = self.findings.families.iter().filter(|score| score.estimator == estimator);
        let valued = scores.filter_map(|score| Some((score.value(Metric::Prediction)?, score.family.as_str())));
        valued.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, family)| family)
    }

    /// The ranking with one estimator; `None` where the best family was compared with no other.
    pub fn ranking(&self, estimator: &str) -> Option<Ranking> {
        let best = self.best_family(estimator)?;
        let over_best = |metric: Metric| -> Vec<Comparison> {
            let of_metric = self.findings.comparisons.iter().filter(|c| c.estimator == estimator && c.metric == metric);
            of_metric.filter_map(|c| c.over(best)).collect()
        };
        let others = over_best(Metric::Prediction);
        let contrary = Metric::ALL.into_iter().filter(|&metric| metric != Metric::Prediction).map(|metric| {
            let mut better = over_best(metric);
            better.retain(|c| c.better.as_ref() == Some(&c.first));
            (metric, better)
        });
        let contrary = contrary.filter(|(_, better)| !better.is_empty()).collect();
        (!others.is_empty()).then(|| Ranking { best: best.to_owned(), others, contrary })
    }
}

/// In how many scenarios each family has the smallest torque error, the most frequent first.
pub(super) fn wins(parts: &[ConditionResult], estimator: &str) -> Vec<(String, usize)> {
    let mut wins: Vec<(String, usize)> = Vec::new();
    for best in parts.iter().filter_map(|part| part.best_family(estimator)) {
        known_or_new(&mut wins, |(family, _)| family == best, || (best.to_owned(), 0)).1 += 1;
    }
    wins.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    wins
}

/// How often each family is better and worse than `reference` in a score, over the scenarios in which the two have an interval.
pub(super) fn tallies(parts: &[ConditionResult], reference: &str, metric: Metric, estimator: &str) -> Vec<Tally> {
    let mut tallies: Vec<Tally> = Vec::new();
    let all = parts.iter().flat_map(|part| &part.findings.comparisons);
    let compared = all.filter(|c| c.estimator == estimator && c.metric == metric && c.interval.is_some());
    for c in compared.filter_map(|c| c.over(reference)) {
        let new = || Tally { family: c.first.clone(), ..Tally::default() };
        let tally = known_or_new(&mut tallies, |tally| tally.family == c.first, new);
        match &c.better {
            Some(better) if *better == c.first => tally.better += 1,
            Some(_) => tally.worse += 1,
            None => tally.open += 1,
        }
    }
    tallies
}

/// The entry of a list that is the one looked for; a new one behind all where there is none.
pub(super) fn known_or_new<T>(list: &mut Vec<T>, is_it: impl Fn(&T) -> bool, new: impl FnOnce() -> T) -> &mut T {
    let at = list.iter().position(is_it).unwrap_or(list.len());
    if at == list.len() {
        list.push(new());
    }
    &mut list[at]
}
