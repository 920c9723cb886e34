//! The same study on several robots, side by side: does what one robot says hold on the others?

use std::collections::BTreeMap;

use super::agreement::Agreement;
use super::comparison::Comparison;
use super::metric::Metric;
use super::ranking::known_or_new;
use super::result::StudyResult;
use crate::provenance::Provenance;
use crate::statistics::Interval;

/// The stored summary above the folders of the robots. Equal results, equal bytes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotsSummary {
    /// The robots, in the order of the plan.
    pub robots: Vec<RobotResult>,
    /// Name of the study.
    pub name: String,
    /// The question that the study answers.
    pub question: String,
    /// Families that every other is compared with; all pairs where there are none.
    pub compare_with: Vec<String>,
    /// Names of the conditions.
    pub conditions: Vec<String>,
    /// Names of the estimators.
    pub estimators: Vec<String>,
    /// Every comparison of two families in one metric under one condition, on each robot.
    pub comparisons: Vec<RobotsComparison>,
    /// How many comparisons the robots agree on.
    pub agreements: Vec<AgreementCounts>,
}

/// The study on one robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotResult {
    /// The robot, as the plan names it.
    pub robot: String,
    /// The folder of its results, beside this summary.
    pub folder: String,
    /// What produced them.
    pub provenance: Provenance,
    /// Base parameters of the robot.
    pub parameters: usize,
    /// Designs of all families.
    pub designs: usize,
    /// Runs of all designs under all conditions.
    pub runs: usize,
}

/// Two families in one metric under one condition, on each robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotsComparison {
    /// Name of the condition.
    pub condition: String,
    /// The metric.
    pub metric: Metric,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the first family.
    pub first: String,
    /// Name of the second family: the one of `compare_with`, where one of the two is.
    pub second: String,
    /// First over second on each robot, in their order; `None` where a robot has not both families.
    pub robots: Vec<Option<RobotDifference>>,
    /// Whether the robots say the same.
    pub agreement: Agreement,
}

/// The difference between two families on one robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotDifference {
    /// First over second; for a logarithmic metric first minus second. Below 1 (0): the first is better.
    pub difference: f64,
    /// Its 95 % interval, of this comparison alone.
    pub interval: Option<Interval>,
    /// The p-value as the robot's own study adjusts it.
    pub p_adjusted: Option<f64>,
    /// The better family, where the robot's own study calls one so.
    pub better: Option<String>,
}

/// How many comparisons of one metric and estimator the robots agree on.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct AgreementCounts {
    /// The metric.
    pub metric: Metric,
    /// Name of the estimator.
    pub estimator: String,
    /// On every robot the same family is better.
    pub same: usize,
    /// Decided on some robots, undecided on the others.
    pub in_part: usize,
    /// Decided one way on one robot and the other way on another.
    pub reversed: usize,
    /// Undecided on every robot.
    pub undecided: usize,
    /// Compared on one robot alone.
    pub one_robot: usize,
    /// Whether all that one robot decides is decided the same way on every other that has both families.
    pub holds: bool,
}

/// A comparison's place: condition, pair of families in the order in which they were found, estimator, metric.
type Place = [usize; 4];

impl RobotsSummary {
    /// Sets the results of one study on several robots side by side.
    pub fn from_results(results: &[StudyResult]) -> Self {
        let first = results.first().map(|result| &result.plan);
        let compare_with = first.map_or_else(Vec::new, |plan| plan.compare_with.clone());
        let comparisons = side_by_side(results, &compare_with);
        Self {
            robots: results.iter().map(RobotResult::of).collect(),
            name: first.map_or_else(String::new, |plan| plan.name.clone()),
            question: first.map_or_else(String::new, |plan| plan.question.clone()),
            compare_with,
            conditions: names_of_conditions(results),
            estimators: first.map_or_else(Vec::new, |plan| plan.identification.estimators.clone()),
            agreements: counts(&comparisons),
            comparisons,
        }
    }
}

impl RobotResult {
    fn of(result: &StudyResult) -> Self {
        let runs = result.conditions.iter().flat_map(|part| &part.statuses).map(|status| status.runs).sum();
        Self {
            robot: result.plan.robot.clone(),
            folder: result.plan.robot_folder(),
            provenance: result.provenance.clone(),
            parameters: result.parameters.len(),
            designs: result.designs.len(),
            runs,
        }
    }
}

impl RobotDifference {
    pub(super) fn of(c: &Comparison) -> Self {
        let Comparison { difference, interval, p_adjusted, better, .. } = c.clone();
        Self { difference, interval, p_adjusted, better }
    }
}

impl AgreementCounts {
    fn add(&mut self, agreement: Agreement) {
        match agreement {
            Agreement::Same => self.same += 1,
            Agreement::InPart => self.in_part += 1,
            Agreement::Reversed => self.reversed += 1,
            Agreement::Undecided => self.undecided += 1,
            Agreement::OneRobot => self.one_robot += 1,
        }
        self.holds = self.in_part == 0 && self.reversed == 0;
    }

    /// The number of comparisons with this agreement.
    pub const fn count(&self, agreement: Agreement) -> usize {
        match agreement {
            Agreement::Same => self.same,
            Agreement::InPart => self.in_part,
            Agreement::Reversed => self.reversed,
            Agreement::Undecided => self.undecided,
            Agreement::OneRobot => self.one_robot,
        }
    }
}

/// Names of the conditions, in the order of the first robot.
fn names_of_conditions(results: &[StudyResult]) -> Vec<String> {
    let parts = results.first().into_iter().flat_map(|result| &result.conditions);
    parts.map(|part| part.condition.name.clone()).collect()
}

/// Every comparison of any robot: conditions in the plan's order, pairs in the order in which robots first have them.
fn side_by_side(results: &[StudyResult], compare_with: &[String]) -> Vec<RobotsComparison> {
    let mut pairs: BTreeMap<[String; 2], usize> = BTreeMap::new();
    let mut found: BTreeMap<Place, RobotsComparison> = BTreeMap::new();
    for (robot, result) in results.iter().enumerate() {
        for (condition, part) in result.conditions.iter().enumerate() {
            for c in &part.findings.comparisons {
                let is_turned = compare_with.contains(&c.first) && !compare_with.contains(&c.second);
                let c = if is_turned { c.turned() } else { c.clone() };
                let (first, second) = (&c.first, &c.second);
                let next = pairs.len();
                let pair = *pairs.entry([first.clone(), second.clone()]).or_insert(next);
                let estimators = &result.plan.identification.estimators;
                let estimator = place(estimators, &c.estimator);
                let row = found.entry([condition, pair, estimator, place(&Metric::ALL, &c.metric)]);
                let row = row.or_insert_with(|| RobotsComparison {
                    condition: part.condition.name.clone(),
                    metric: c.metric,
                    estimator: c.estimator.clone(),
                    first: first.clone(),
                    second: second.clone(),
                    robots: vec![None; results.len()],
                    agreement: Agreement::OneRobot,
                });
                row.robots[robot] = Some(RobotDifference::of(&c));
            }
        }
    }
    let mut comparisons: Vec<RobotsComparison> = found.into_values().collect();
    for row in &mut comparisons {
        let better: Vec<Option<&str>> = row.robots.iter().flatten().map(|one| one.better.as_deref()).collect();
        row.agreement = Agreement::from_better(&better);
    }
    comparisons
}

/// The place of a value in a list; behind all where it is none of them.
fn place<T: PartialEq>(list: &[T], value: &T) -> usize {
    list.iter().position(|other| other == value).unwrap_or(list.len())
}

/// Counts of each metric and estimator, in the order in which they first appear.
fn counts(comparisons: &[RobotsComparison]) -> Vec<AgreementCounts> {
    let mut counts: Vec<AgreementCounts> = Vec::new();
    for row in comparisons {
        let (metric, estimator) = (row.metric, &row.estimator);
        let new = || AgreementCounts { metric, estimator: estimator.clone(), ..AgreementCounts::default() };
        known_or_new(&mut counts, |of| of.metric == metric && of.estimator == *estimator, new).add(row.agreement);
    }
    counts
}
