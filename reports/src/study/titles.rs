//! What the figures of a study show, each in one sentence: their titles.

use armid::excitation::CriterionKind;
use armid::number::significant;
use armid::study::{
    FamilyScore, Metric, PredictionExample, ReportInput, SensitivityEntry, StudyDesign, capitalised, criterion_in_words,
};

use crate::{Interval, IntervalRow};

/// How closely the best three starts of each optimised family agree; `None` of fewer, or of values that cannot be compared.
pub(super) fn convergence(input: &ReportInput) -> Option<String> {
    let plan = &input.result.plan;
    let spread = |family: usize| {
        let of_family = |design: &&StudyDesign| design.family == family && design.history.len() > 1;
        let found: Vec<&StudyDesign> = input.result.designs.iter().filter(of_family).collect();
        best_three(&found, input.result.parameters.len())
    };
    let (family, worst) = (0..plan.designs.len())
        .filter_map(|family| Some((family, spread(family)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let name = criterion_in_words(&plan.designs[family].name);
    Some(format!("Best three starts agree within {} % (least: {name})", significant(100.0 * worst, 2)))
}

/// Relative spread of the best three values; of ln det that of det^(1/p), the D-efficiency.
fn best_three(designs: &[&StudyDesign], parameters: usize) -> Option<f64> {
    let kind = CriterionKind::parse(designs.first()?.criterion.as_deref()?)?;
    if kind == CriterionKind::ConditionPlusD {
        return None;
    }
    let mut values: Vec<f64> = designs.iter().map(|design| design.own_value()).collect();
    values.sort_by(f64::total_cmp);
    let (best, third) = (values[0], *values.get(2)?);
    let spread = match kind {
        CriterionKind::DOptimal => 1.0 - libm::exp((best - third) / parameters.max(1) as f64),
        _ => (third / best - 1.0).abs(),
    };
    spread.is_finite().then_some(spread)
}

/// How many parameters have a bias beyond chance.
pub(super) fn bias(families: &[&FamilyScore]) -> Option<String> {
    let intervals = families.iter().flat_map(|family| &family.parameters).filter_map(|score| score.bias_interval);
    let (mut all, mut biased) = (0, 0);
    for interval in intervals {
        all += 1;
        biased += usize::from(interval.low > 0.0 || interval.high < 0.0);
    }
    let chance = (0.05 * f64::from(all)).round();
    (all > 0).then(|| format!("{biased} of {all} parameter errors have a bias; chance alone gives {chance}"))
}

/// How often stated intervals cover the true value, over all parameters and families.
pub(super) fn coverage(families: &[&FamilyScore]) -> Option<String> {
    let shares: Vec<f64> = families.iter().flat_map(|family| &family.parameters).map(|score| score.coverage).collect();
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    (!shares.is_empty())
        .then(|| format!("Stated 95 % intervals cover the true value in {:.1} % of cases", 100.0 * mean))
}

/// Which value of a design goes with its torque error, by rank correlation.
pub(super) fn criterion_and_error(input: &ReportInput) -> Option<String> {
    let shown = input.result.shown_estimator();
    let all = &input.result.findings().criterion_correlations;
    let of_torque = all.iter().filter(|found| found.metric == Metric::Prediction && found.estimator == shown);
    let with_interval = of_torque.filter_map(|found| Some((found, found.rank_correlation?, found.interval?)));
    let (best, rho, interval) = with_interval.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let value = criterion_in_words(&best.value);
    Some(if interval.low > 0.0 {
        format!("Smaller torque error goes with the criterion {value}: Spearman's ρ is {rho:.2}")
    } else {
        "No value of a design predicts its torque error significantly".to_owned()
    })
}

/// Which family estimates parameters better than all others, by adjusted p-values.
pub(super) fn parameters(input: &ReportInput) -> Option<String> {
    let (shown, findings) = (input.result.shown_estimator(), input.result.findings());
    let compared: Vec<_> = findings
        .comparisons
        .iter()
        .filter(|found| found.metric == Metric::Reference && found.estimator == shown && found.p_adjusted.is_some())
        .collect();
    let families = &input.result.plan.designs;
    let beats_all = |name: &str| {
        let own = compared.iter().filter(|found| found.first == name || found.second == name);
        let wins = own.filter(|found| found.better.as_deref() == Some(name)).count();
        wins + 1 == families.len()
    };
    if compared.is_empty() || families.len() < 2 {
        return None;
    }
    Some(match families.iter().find(|family| beats_all(&family.name)) {
        Some(best) => format!("{} designs estimate parameters best", capitalised(&criterion_in_words(&best.name))),
        None => "No criterion estimates parameters significantly better than all others".to_owned(),
    })
}

/// What the first sequence of experiments gains in predicted torque.
pub(super) fn rounds(errors: &[f64]) -> Option<String> {
    let (first, last) = (errors.first()?, errors.last()?);
    let (count, ratio) = (errors.len(), significant(last / first, 2));
    (count > 1).then(|| format!("After {count} experiments the torque error is {ratio} times that of one"))
}

/// Largest share of a joint's torque that an estimate leaves unexplained.
pub(super) fn prediction(example: &PredictionExample, joints: &[String]) -> Option<String> {
    let rms = |values: &[f64]| (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt();
    let shares = example.rms.iter().zip(&example.measured).map(|(error, measured)| error / rms(measured));
    let (joint, worst) = joints.iter().zip(shares).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let percent = significant(100.0 * worst, 2);
    worst.is_finite().then(|| format!("At most {percent} % of a joint's held-out torque is unexplained ({joint})"))
}

/// In how many scenarios the best estimator of most is the best.
pub(super) fn estimators(names: &[String], over_best: &[Vec<Option<f64>>]) -> Option<String> {
    let wins = |column: usize| over_best.iter().filter(|row| row[column] == Some(1.0)).count();
    let (best, wins) = (0..names.len())
        .map(|column| (column, wins(column)))
        .max_by_key(|(column, wins)| (*wins, usize::MAX - column))?;
    Some(format!("{} has the least error in {wins} of {} scenarios", names[best], over_best.len()))
}

/// In how many scenarios the group that is better most often has an interval below 1, and above; not adjusted for their number.
pub(super) fn against(names: &[&str], rows: &[IntervalRow], reference: &str) -> Option<String> {
    let count = |group: usize, is: fn(&Interval) -> bool| {
        rows.iter().filter(|row| row.cells.get(group).copied().flatten().is_some_and(|cell| is(&cell))).count()
    };
    let better = |group: usize| count(group, |cell| cell.high < 1.0);
    let best = (0..names.len()).max_by_key(|group| (better(*group), usize::MAX - group))?;
    let worse = count(best, |cell| cell.low > 1.0);
    let name = capitalised(&criterion_in_words(names[best]));
    Some(format!(
        "{name} is below {reference} in {} of {} scenarios, above in {worse} (95 % intervals)",
        better(best),
        rows.len()
    ))
}

/// How many of the intervals of a figure exclude 1.
pub(super) fn differences(rows: &[IntervalRow]) -> String {
    let cells: Vec<Interval> = rows.iter().flat_map(|row| row.cells.iter().copied().flatten()).collect();
    let apart = cells.iter().filter(|cell| cell.high < 1.0 || cell.low > 1.0).count();
    format!("{apart} of {} intervals exclude a ratio of 1", cells.len())
}

/// In how many scenarios on how many robots the first family's interval is below the second's error, and above; not adjusted for
/// their number.
pub(super) fn pair_on_robots(first: &str, second: &str, rows: &[IntervalRow]) -> String {
    let cells: Vec<Interval> = rows.iter().flat_map(|row| row.cells.iter().copied().flatten()).collect();
    let count = |is: fn(&Interval) -> bool| cells.iter().filter(|cell| is(cell)).count();
    format!(
        "{}: below {second} in {} of {} cases, above in {} (95 % intervals)",
        capitalised(first),
        count(|cell| cell.high < 1.0),
        cells.len(),
        count(|cell| cell.low > 1.0)
    )
}

/// The parameter that an effect biases most.
pub(super) fn biased_most(shown: &[&SensitivityEntry], names: &[String]) -> Option<String> {
    let all = shown
        .iter()
        .flat_map(|entry| entry.parameters.iter().zip(names).map(|(bias, name)| (*entry, name, bias.in_std.abs())));
    let (entry, name, size) = all.filter(|(_, _, size)| size.is_finite()).max_by(|a, b| a.2.total_cmp(&b.2))?;
    let times = significant(size, 2);
    Some(format!("{} biases {name} most: {times} stated standard deviations", capitalised(&entry.condition)))
}

/// The row and column of the least value of a grid.
pub(super) fn least(rows: &[String], columns: &[String], values: &[Option<f64>], what: &str) -> Option<String> {
    let known = values.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?)));
    let (at, _) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (row, column) = (criterion_in_words(&rows[at / columns.len()]), &columns[at % columns.len()]);
    Some(format!("{} with {column} has the least {what}", capitalised(&row)))
}

#[cfg(test)]
mod tests {
    use super::{against, differences, estimators, least, pair_on_robots, rounds};
    use crate::{Interval, IntervalRow};

    fn rows() -> Vec<IntervalRow> {
        let row = |cells: [(f64, f64); 2]| IntervalRow {
            label: "scenario".into(),
            cells: cells.map(|(low, high)| Some(Interval::new(0.5 * (low + high), low, high))).to_vec(),
        };
        vec![row([(0.7, 0.9), (0.8, 0.95)]), row([(0.9, 1.2), (0.5, 0.6)]), row([(1.1, 1.3), (1.2, 1.5)])]
    }

    #[test]
    fn analytic_titles_count_what_excludes_one() {
        // The second group wins twice and loses once; five of six intervals exclude 1.
        let said = against(&["condition", "i-optimal"], &rows(), "D-optimal").unwrap();
        assert_eq!(said, "I-optimal is below D-optimal in 2 of 3 scenarios, above in 1 (95 % intervals)");
        assert_eq!(differences(&rows()), "5 of 6 intervals exclude a ratio of 1");
        let said = pair_on_robots("condition number", "D-optimal", &rows());
        assert_eq!(said, "Condition number: below D-optimal in 3 of 6 cases, above in 2 (95 % intervals)");
    }

    #[test]
    fn analytic_titles_name_the_best() {
        let names = ["wls".to_owned(), "ols".to_owned()];
        let over = [vec![Some(1.0), Some(1.4)], vec![Some(1.0), None], vec![Some(2.0), Some(1.0)]];
        assert_eq!(estimators(&names, &over).unwrap(), "wls has the least error in 2 of 3 scenarios");
        let (rows, columns) = (["condition".to_owned(), "d-optimal".to_owned()], ["3".to_owned(), "5".to_owned()]);
        let values = [Some(3.0), None, Some(2.0), Some(2.5)];
        assert_eq!(least(&rows, &columns, &values, "error").unwrap(), "D-optimal with 3 has the least error");
        assert_eq!(rounds(&[4.0, 3.0, 2.0]).unwrap(), "After 3 experiments the torque error is 0.5 times that of one");
        assert_eq!(rounds(&[4.0]), None);
    }
}
