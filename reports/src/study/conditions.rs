//! Do the differences between criteria hold in every scenario, and on every arm?

use armid::study::{Comparison, ConditionResult, Metric, ReportInput, criterion_in_words};

use super::titles;
use crate::{
    Axis, Cell, Column, DocumentError, Group, Heading, Interval, IntervalFigure, IntervalRow, Level, Section, Table,
};

/// Metrics that have a figure over conditions.
const SHOWN: [Metric; 7] = [
    Metric::Prediction,
    Metric::Slow,
    Metric::PointToPoint,
    Metric::Static,
    Metric::Measured,
    Metric::Reference,
    Metric::Si,
];

/// More conditions than a figure of pairs can show apart.
const MOST: usize = 8;

/// A section on conditions where a study has several, and on truths where it draws them.
pub(super) fn section(input: &ReportInput) -> Result<Option<Section>, DocumentError> {
    let parts = &input.result.conditions;
    if parts.len() > MOST {
        return beside_one_family(input);
    }
    let drawn = !input.result.findings().over_truths.is_empty();
    // One family has nothing to be compared with.
    let compared = (2..=MOST).contains(&parts.len()) && !input.result.findings().comparisons.is_empty();
    if !drawn && !compared {
        return Ok(None);
    }
    let estimator = input.result.shown_estimator();
    let mut section = Section::new("Does it hold in other scenarios?");
    if compared {
        section = section.text("Every run of every design is performed in every scenario with the same noise.");
        section = with_figure(section, &by_condition(parts, estimator))?.table(comparisons(parts, estimator));
    }
    if drawn && parts.len() <= MOST {
        section = section.text("Each arm has other parameters that are physically possible. All designs are performed on the same arms, which are the units of the intervals.");
        section = with_figure(section, &over_truths(parts, estimator, input.result.drawn_truths.len()))?;
        section = section.table(truths(parts, estimator));
    }
    Ok(Some(section))
}

/// With a figure, where it shows an interval: one arm gives none, nor does one criterion whose fits succeed.
fn with_figure(section: Section, figure: &IntervalFigure) -> Result<Section, DocumentError> {
    let is_shown = figure.rows.iter().any(|row| row.cells.iter().any(Option::is_some));
    if is_shown { section.figure(figure) } else { Ok(section) }
}

/// Many conditions, where the study compares with one family alone: each other family against it, condition by condition.
fn beside_one_family(input: &ReportInput) -> Result<Option<Section>, DocumentError> {
    let (parts, estimator) = (&input.result.conditions, input.result.shown_estimator());
    let [reference] = &input.result.plan.compare_with[..] else { return Ok(None) };
    if input.result.findings().comparisons.is_empty() {
        return Ok(None);
    }
    let mut section = Section::new("Does it hold in other scenarios?")
        .text("Every run of every design is performed in every scenario with the same noise.");
    for metric in SHOWN {
        section = with_figure(section, &against(parts, reference, metric, estimator))?;
    }
    Ok(Some(section.table(comparisons(parts, estimator))))
}

/// The ratio of every other family to one, by condition.
fn against(parts: &[ConditionResult], reference: &str, metric: Metric, estimator: &str) -> IntervalFigure {
    let of = |part: &ConditionResult, family: &str| {
        let of_metric = part.findings.comparisons.iter().filter(|c| c.estimator == estimator && c.metric == metric);
        let found = of_metric.filter_map(|c| c.over(reference)).find(|c| c.first == family)?;
        found.interval.map(|i| around(found.difference, i.low, i.high))
    };
    let others: Vec<&str> = parts
        .first()
        .into_iter()
        .flat_map(|part| &part.findings.families)
        .filter(|score| score.estimator == estimator && score.family != reference)
        .map(|score| score.family.as_str())
        .collect();
    let name = match metric {
        Metric::Prediction => "prediction",
        Metric::PredictionOfRating => "prediction-of-rating",
        Metric::LogVolume => "log-volume",
        Metric::Reference => "parameters",
        Metric::Si => "parameters-si",
        Metric::Measured => "measured-torque",
        Metric::Slow => "slow-motions",
        Metric::PointToPoint => "point-to-point-motions",
        Metric::Static => "static-poses",
    };
    let in_words = criterion_in_words(reference);
    let rows: Vec<IntervalRow> = parts
        .iter()
        .map(|part| IntervalRow {
            label: part.condition.name.clone(),
            cells: others.iter().map(|family| of(part, family)).collect(),
        })
        .collect();
    let title = titles::against(&others, &rows, &in_words);
    IntervalFigure {
        heading: Heading::new(
            format!("{name}-by-condition"),
            title.unwrap_or_else(|| format!("Each criterion relative to {in_words}, by scenario")),
        )
        .subtitle(format!("{}, estimator {estimator}", metric.title()))
        .caption(format!(
            "Ratio of geometric means over designs with its 95 % t interval ({}); left of 1 is better than {in_words}.",
            unit_words(parts, estimator, metric, |c| [c.first.as_str(), c.second.as_str()].contains(&reference))
        )),
        value: Axis::log(format!("error relative to {in_words}"), ""),
        groups: Group::assign(others.iter().map(|family| criterion_in_words(family))),
        rows,
        levels: vec![Level::new(1.0, "no difference")],
        band: None,
    }
}

/// Names of two criteria, as a row shows them.
fn pair(first: &str, second: &str) -> String {
    format!("{} / {}", criterion_in_words(first), criterion_in_words(second))
}

fn by_condition(parts: &[ConditionResult], estimator: &str) -> IntervalFigure {
    let caption = format!(
        "Ratio of geometric means over designs with its 95 % t interval ({}); left of 1 the first is better.",
        unit_words(parts, estimator, Metric::Prediction, |_| true)
    );
    let heading = |title| {
        Heading::new("differences-by-condition", title)
            .subtitle(format!("torque prediction RMSE in every scenario, first over second, estimator {estimator}"))
            .caption(caption)
    };
    of_pairs(heading, parts, |part| {
        let all = part.findings.comparisons.iter();
        all.filter(|c| c.estimator == estimator && c.metric == Metric::Prediction)
            .map(|c| (pair(&c.first, &c.second), c.interval.map(|i| around(c.difference, i.low, i.high))))
            .collect()
    })
}

/// A row for each pair of criteria, a group for each scenario; `column` gives the pairs of one scenario.
fn of_pairs(
    heading: impl FnOnce(String) -> Heading,
    parts: &[ConditionResult],
    column: impl Fn(&ConditionResult) -> Vec<(String, Option<Interval>)>,
) -> IntervalFigure {
    let columns: Vec<Vec<(String, Option<Interval>)>> = parts.iter().map(column).collect();
    let cell =
        |column: &Vec<(String, Option<Interval>)>, label: &String| column.iter().find(|(name, _)| name == label)?.1;
    let rows = columns.first().into_iter().flatten().map(|(label, _)| IntervalRow {
        label: label.clone(),
        cells: columns.iter().map(|column| cell(column, label)).collect(),
    });
    let rows: Vec<IntervalRow> = rows.collect();
    IntervalFigure {
        heading: heading(titles::differences(&rows)),
        value: Axis::log("ratio of prediction RMSE", ""),
        groups: Group::assign(parts.iter().map(|part| part.condition.name.clone())),
        rows,
        levels: vec![Level::new(1.0, "no difference")],
        band: None,
    }
}

/// What is repeated independently in the comparisons that a figure shows, in words.
fn unit_words(
    parts: &[ConditionResult],
    estimator: &str,
    metric: Metric,
    is_shown: impl Fn(&Comparison) -> bool,
) -> String {
    let mut words: Vec<&str> = Vec::new();
    for c in parts.iter().flat_map(|part| &part.findings.comparisons) {
        let is_of_figure = c.estimator == estimator && c.metric == metric && is_shown(c);
        if let Some(unit) = c.unit.filter(|_| is_of_figure)
            && !words.contains(&unit.words())
        {
            words.push(unit.words());
        }
    }
    format!("units: {}", words.join("; "))
}

/// An interval that holds its point, in results too that were stored with one that need not.
fn around(point: f64, low: f64, high: f64) -> Interval {
    Interval::new(point, low.min(point), high.max(point))
}

fn comparisons(parts: &[ConditionResult], estimator: &str) -> Table {
    let mut table = Table::new(
        "Differences between criteria in every scenario, first over second (log volume: first minus second), with 95 % intervals, what is repeated independently, and the p-value as Holm adjusts it within a scenario.",
        Column::list("scenario | metric | first | second | #difference | #low | #high | unit | #adjusted p | better"),
    );
    for part in parts {
        for c in part.findings.comparisons.iter().filter(|c| c.estimator == estimator) {
            table = table.row(vec![
                Cell::text(&part.condition.name),
                Cell::text(c.metric.title()),
                Cell::text(&c.first),
                Cell::text(&c.second),
                Cell::fixed(c.difference, 3),
                c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.low, 3)),
                c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.high, 3)),
                c.unit.map_or(Cell::Missing, |unit| Cell::text(unit.words())),
                c.p_adjusted.map_or(Cell::Missing, |p| Cell::number(p, 2)),
                c.better.as_ref().map_or(Cell::Missing, Cell::text),
            ]);
        }
    }
    table
}

fn over_truths(parts: &[ConditionResult], estimator: &str, count: usize) -> IntervalFigure {
    let heading = |title| {
        Heading::new("differences-over-truths", title)
            .subtitle(format!("torque prediction RMSE, first over second, {count} arms, estimator {estimator}"))
            .caption("Geometric mean of the ratio over arms with its 95 % t interval; left of 1 the first is better.")
    };
    of_pairs(heading, parts, |part| {
        let all = part.findings.over_truths.iter();
        all.filter(|c| c.estimator == estimator && c.metric == Metric::Prediction)
            .map(|c| (pair(&c.first, &c.second), c.interval.map(|i| around(c.ratio, i.low, i.high))))
            .collect()
    })
}

fn truths(parts: &[ConditionResult], estimator: &str) -> Table {
    let mut table = Table::new(
        "Differences between criteria over random arms, first over second: geometric mean with its 95 % interval, the range over arms, and for how many of them the first is better.",
        Column::list(
            "scenario | metric | first | second | #ratio | #low | #high | #smallest | #largest | \
             #first better | #arms",
        ),
    );
    for part in parts {
        for c in part.findings.over_truths.iter().filter(|c| c.estimator == estimator) {
            table = table.row(vec![
                Cell::text(&part.condition.name),
                Cell::text(c.metric.title()),
                Cell::text(&c.first),
                Cell::text(&c.second),
                Cell::fixed(c.ratio, 3),
                c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.low, 3)),
                c.interval.map_or(Cell::Missing, |i| Cell::fixed(i.high, 3)),
                Cell::fixed(c.range.low, 3),
                Cell::fixed(c.range.high, 3),
                Cell::count(c.first_better),
                Cell::count(c.truths),
            ]);
        }
    }
    table
}
