//! Experiments one after the other: what each round gains.

use armid::study::{FamilyScore, ReportInput};

use super::titles;
use crate::{
    Axis, Cell, Column, DocumentError, GroupStyle, Heading, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint,
    Section, Table,
};

/// Panels: title, axis, value and interval of a family after a number of experiments.
type Panel = (&'static str, Axis, fn(&FamilyScore, usize) -> Option<ScatterValue>);

/// A value with the interval that it has, if any.
type ScatterValue = (f64, Option<(f64, f64)>);

/// The families from the first experiment to this one.
fn sequence(input: &ReportInput, family: usize) -> Vec<usize> {
    let designs = &input.result.plan.designs;
    let mut sequence = vec![family];
    while let Some(before) = designs[sequence[sequence.len() - 1]].after.as_ref() {
        let Some(index) = designs.iter().position(|other| other.name == *before) else { break };
        sequence.push(index);
    }
    sequence.reverse();
    sequence
}

/// The sequences that nothing continues in the same way: one line of the figure each.
fn sequences(input: &ReportInput) -> Vec<Vec<usize>> {
    let designs = &input.result.plan.designs;
    let continued = |name: &str| designs.iter().any(|other| other.after.as_deref() == Some(name));
    let last = (0..designs.len()).filter(|&family| !continued(&designs[family].name));
    last.map(|family| sequence(input, family)).filter(|sequence| sequence.len() > 1).collect()
}

/// The section, where the study has experiments one after the other.
pub(super) fn section(input: &ReportInput) -> Result<Option<Section>, DocumentError> {
    let sequences = sequences(input);
    if sequences.is_empty() {
        return Ok(None);
    }
    let estimator = input.result.shown_estimator();
    let designs = &input.result.plan.designs;
    let score = |family: usize| {
        let scores = input.result.findings().families.iter();
        scores.filter(|score| score.estimator == estimator).find(|score| score.family == designs[family].name)
    };
    let panels: [Panel; 5] = [
        ("Torque prediction", Axis::log("prediction RMSE", "N·m"), |score, _| value(score, 0)),
        ("Parameters", Axis::log("parameter RMSE", "reference units"), |score, _| value(score, 3)),
        ("Bound", Axis::log("median bound", "reference units"), |score, _| score.bound_in_units.map(|b| (b, None))),
        ("Bound of one experiment", Axis::log("bound · √experiments", "reference units"), |score, experiments| {
            score.bound_per_experiment(experiments).map(|b| (b, None))
        }),
        ("Volume", Axis::linear("log volume of the error", ""), |score, _| value(score, 2)),
    ];
    let errors: Vec<f64> = sequences[0].iter().filter_map(|&family| Some(value(score(family)?, 0)?.0)).collect();
    let figure = ScatterFigure {
        heading: Heading::new("rounds", titles::rounds(&errors).unwrap_or_else(|| "What each round gains".to_owned()))
            .subtitle(format!("error after one experiment, two, …, all of the same length; {estimator}"))
            .caption("Bars: 95 % t intervals over designs (over runs of an only design; those of a volume by bootstrap over designs and runs). The bound is the median over parameters of the Cramér–Rao standard deviation; that of one experiment falls as long as a round gains more than the same experiments again."),
        columns: 2,
        panels: panels
            .into_iter()
            .map(|(title, axis, value)| ScatterPanel {
                title: title.to_owned(),
                x: Axis::linear("experiments", ""),
                y: axis,
                groups: sequences
                    .iter()
                    .enumerate()
                    .map(|(index, sequence)| ScatterGroup {
                        label: designs[sequence[sequence.len() - 1]].name.clone(),
                        style: GroupStyle::nth(index),
                        points: sequence
                            .iter()
                            .enumerate()
                            .filter_map(|(round, &family)| {
                                let (value, interval) = value(score(family)?, round + 1)?;
                                let point = ScatterPoint::new((round + 1) as f64, value);
                                Some(interval.map_or(point, |(low, high)| point.interval(low, high)))
                            })
                            .collect(),
                    })
                    // A volume is not defined for few runs.
                    .filter(|group: &ScatterGroup| !group.points.is_empty())
                    .collect(),
                references: Vec::new(),
            })
            .filter(|panel| !panel.groups.is_empty())
            .collect(),
    };
    let mut table = Table::new(
        "Each round of each sequence, with 95 % intervals; the last columns: median over parameters of the bound, the same of one experiment, and median of the standard deviation over its bound.",
        Column::list(
            "chain | #experiments | last design | #prediction [N·m] | #low | #high | #parameters [ref. units] | \
             #log volume | #bound [ref. units] | #bound · √experiments [ref. units] | #std / bound",
        ),
    );
    for sequence in &sequences {
        for (round, &family) in sequence.iter().enumerate() {
            let Some(score) = score(family) else { continue };
            let interval = score.intervals[0];
            table = table.row(vec![
                Cell::text(&designs[sequence[sequence.len() - 1]].name),
                Cell::count(round + 1),
                Cell::text(&score.family),
                score.values[0].map_or(Cell::Missing, |value| Cell::number(value, 3)),
                interval.map_or(Cell::Missing, |interval| Cell::number(interval.low, 3)),
                interval.map_or(Cell::Missing, |interval| Cell::number(interval.high, 3)),
                score.values[3].map_or(Cell::Missing, |value| Cell::number(value, 3)),
                score.values[2].map_or(Cell::Missing, |value| Cell::fixed(value, 1)),
                score.bound_in_units.map_or(Cell::Missing, |value| Cell::number(value, 3)),
                score.bound_per_experiment(round + 1).map_or(Cell::Missing, |value| Cell::number(value, 3)),
                score.std_over_bound.map_or(Cell::Missing, |value| Cell::fixed(value, 2)),
            ]);
        }
    }
    Ok(Some(Section::new("Rounds").figure(&figure)?.table(table)))
}

fn value(score: &FamilyScore, metric: usize) -> Option<ScatterValue> {
    let interval = score.intervals[metric].map(|interval| (interval.low, interval.high));
    score.values[metric].map(|value| (value, interval))
}
