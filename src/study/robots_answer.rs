//! The answer of a study on several robots: whether they agree, then pair by pair.

use super::agreement::Agreement;
use super::criterion_words::{capitalised, criterion_pair_in_words};
use super::metric::Metric;
use super::robots_summary::{RobotsComparison, RobotsSummary};
use crate::model::distinct;

/// Metrics that the answer tells of.
const TOLD: [Metric; 2] = [Metric::Prediction, Metric::Measured];

impl RobotsSummary {
    /// The answer in paragraphs, what was found in bold (`**`).
    pub fn answer(&self) -> Vec<String> {
        let estimator = self.shown_estimator();
        let mut paragraphs = Vec::new();
        for metric in TOLD {
            let counts = self.agreements.iter().find(|c| c.metric == metric && c.estimator == estimator);
            let Some(counts) = counts else { continue };
            let [same, in_part, reversed, undecided, alone] = Agreement::ALL.map(|agreement| counts.count(agreement));
            let significant = same + in_part + reversed;
            let mut words = format!(
                "**{}: {same} of {significant} significant comparisons agree on every robot, {reversed} are reversed.** Significant on some robots only: {in_part}. Not significant on any: {undecided}.",
                capitalised(metric.title())
            );
            if alone > 0 {
                words += &format!(" Compared on one robot alone: {alone}.");
            }
            paragraphs.push(words);
        }
        paragraphs.extend(self.pairs().into_iter().filter_map(|pair| self.sentence(pair, estimator)));
        paragraphs
    }

    /// Pairs of families, in the order in which they were found.
    pub fn pairs(&self) -> Vec<[&str; 2]> {
        distinct(self.comparisons.iter().map(|row| [row.first.as_str(), row.second.as_str()]))
    }

    /// A pair in one metric under every condition.
    pub fn rows(&self, [first, second]: [&str; 2], metric: Metric, estimator: &str) -> Vec<&RobotsComparison> {
        let of_metric = self.comparisons.iter().filter(|row| row.metric == metric && row.estimator == estimator);
        of_metric.filter(|row| row.first == first && row.second == second).collect()
    }

    /// The estimator that is shown: the last of the plan that was compared.
    pub fn shown_estimator(&self) -> &str {
        let compared = |name: &&String| self.agreements.iter().any(|counts| counts.estimator == **name);
        self.estimators.iter().rev().find(compared).map_or("", String::as_str)
    }

    /// In how many scenarios, and which, the robots agree on a pair of criteria in the first score.
    fn sentence(&self, [first, second]: [&str; 2], estimator: &str) -> Option<String> {
        let rows = self.rows([first, second], Metric::Prediction, estimator);
        if rows.is_empty() {
            return None;
        }
        let (mut better, mut worse) = (0, 0);
        for row in rows.iter().filter(|row| row.agreement == Agreement::Same) {
            match row.robots.iter().flatten().find_map(|one| one.better.as_deref()) {
                Some(family) if family == first => better += 1,
                Some(_) => worse += 1,
                None => {}
            }
        }
        let named = |agreement: Agreement| -> (usize, String) {
            let of = rows.iter().filter(|row| row.agreement == agreement);
            let names: Vec<&str> = of.map(|row| row.condition.as_str()).collect();
            (names.len(), format!("{} in {} ({})", agreement.words(), names.len(), names.join("; ")))
        };
        let parts = [
            (better, format!("better on every robot in {better}")),
            (worse, format!("worse on every robot in {worse}")),
            named(Agreement::Reversed),
            named(Agreement::InPart),
            named(Agreement::Undecided),
            named(Agreement::OneRobot),
        ];
        let parts: Vec<String> = parts.into_iter().filter(|(count, _)| *count > 0).map(|(_, words)| words).collect();
        Some(format!("**{}**, {} scenarios: {}.", criterion_pair_in_words(first, second), rows.len(), parts.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use crate::study::small_results::{compared, scenario, score, study};
    use crate::study::{Metric, RobotsSummary};

    #[test]
    fn analytic_robots_that_agree_and_disagree_are_counted_and_named() {
        let turned = ["d-optimal", "condition"];
        let pair = ["condition", "d-optimal"];
        // First over second on each of two robots; the reference stands in front on the second robot.
        let cases = [
            ("same", Some(0), Some(1)),
            ("worse", Some(1), Some(0)),
            ("reversed", Some(0), Some(0)),
            ("part", None, Some(1)),
            ("open", None, None),
        ];
        let robot = |is_second: bool| {
            let part = |(name, one, other): (&str, Option<usize>, Option<usize>)| {
                let (pair, better) = if is_second { (turned, other) } else { (pair, one) };
                let families = vec![score("condition", Some(1.0)), score("d-optimal", Some(1.0))];
                scenario(name, families, vec![compared(Metric::Prediction, pair, [0.5, 0.8, 2.0], better)])
            };
            study(cases.into_iter().map(part).collect(), &["d-optimal"])
        };
        let summary = RobotsSummary::from_results(&[robot(false), robot(true)]);
        let [first, second] = [0, 1].map(|robot| summary.comparisons[0].robots[robot].clone().unwrap());
        assert_eq!(first.difference.to_bits(), 0.8_f64.to_bits());
        assert_eq!(second.difference.to_bits(), 1.25_f64.to_bits());
        let interval = second.interval.unwrap();
        assert_eq!((interval.low.to_bits(), interval.high.to_bits()), (0.5_f64.to_bits(), 2.0_f64.to_bits()));
        assert_eq!(
            summary.answer(),
            [
                "**Torque prediction RMSE, N·m: 2 of 4 significant comparisons agree on every robot, 1 are reversed.** Significant on some robots only: 1. Not significant on any: 1.",
                "**Condition number against D-optimal**, 5 scenarios: better on every robot in 1, worse on every robot in 1, reversed in 1 (reversed), significant on some robots in 1 (part), not significant on any robot in 1 (open).",
            ]
        );
        let alone = RobotsSummary::from_results(&[robot(false)]).answer();
        assert!(alone[0].ends_with(" Compared on one robot alone: 5."), "{alone:?}");
    }
}
