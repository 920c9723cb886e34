//! The page of one study on several robots: what one robot says, beside what the others say.

use armid::study::{
    Metric, RobotDifference, RobotsComparison, RobotsSummary, criterion_in_words, criterion_pair_in_words,
};

use super::overview::TESTED;
use super::selection::GROUPS;
use super::titles;
use crate::heading::file_stem;
use crate::{
    Axis, Cell, Column, Document, DocumentError, Group, Heading, Interval, IntervalFigure, IntervalRow, Level, Section,
    Table,
};

/// The page of one study on several robots, with the answer, every comparison robot by robot, and links to the pages of the
/// robots.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn from what is stored.
pub fn robots_document(summary: &RobotsSummary) -> Result<Document, DocumentError> {
    let robots: Vec<&str> = summary.robots.iter().map(|robot| robot.robot.as_str()).collect();
    let mut document = Document::new(&summary.question).subtitle(format!(
        "{} on {}, {} scenarios on each",
        summary.name,
        robots.join(", "),
        summary.conditions.len()
    ));
    for paragraph in summary.answer() {
        document = document.summary(paragraph);
    }
    document = document.section(pages(summary));
    let pairs = summary.pairs();
    // Hundreds of sections show nothing: the table at the end has every pair.
    if pairs.len() <= GROUPS {
        for pair in &pairs {
            document = document.section(of_pair(summary, *pair)?);
        }
    }
    document = document.section(every_score(summary));
    for robot in &summary.robots {
        let p = &robot.provenance;
        let words = format!(
            "{}, SHA-256 of its file {}, armid {}, seed {}",
            p.robot,
            p.robot_sha256,
            p.version,
            p.seed.map_or_else(|| "none".to_owned(), |seed| seed.value().to_string())
        );
        document = document.provenance(&robot.robot, words);
    }
    Ok(document)
}

/// Where the page of each robot is, and what stands behind it.
fn pages(summary: &RobotsSummary) -> Section {
    let columns = Column::list("robot | #base parameters | #designs | #runs");
    let mut table = Table::new("The study on each robot: one plan, performed on one after the other.", columns);
    for robot in &summary.robots {
        table = table.row(vec![
            Cell::text(&robot.robot),
            Cell::count(robot.parameters),
            Cell::count(robot.designs),
            Cell::count(robot.runs),
        ]);
    }
    Section::new("The robots")
        .text("Each robot has its own study with its own page, tests and adjusted p-values; nothing is pooled over robots.")
        .links(summary.robots.iter().map(|robot| (robot.robot.clone(), format!("../{}/report/report.html", robot.folder))))
        .table(table)
}

/// A pair of families on every robot, condition by condition: the score that ranks, and measured torque where there is some.
fn of_pair(summary: &RobotsSummary, pair: [&str; 2]) -> Result<Section, DocumentError> {
    let [first, second] = pair;
    let estimator = summary.shown_estimator();
    let mut section = Section::new(criterion_pair_in_words(first, second));
    for metric in [Metric::Prediction, Metric::Measured] {
        let rows = summary.rows(pair, metric, estimator);
        let figure = figure(summary, pair, metric, &rows);
        let has_intervals = figure.rows.iter().any(|row| row.cells.iter().any(Option::is_some));
        if has_intervals {
            section = section.figure(&figure)?;
        } else if metric == Metric::Measured {
            continue;
        }
        let mut columns = vec![Column::text("scenario")];
        columns.extend(summary.robots.iter().map(|robot| Column::number(&robot.robot, "")));
        columns.push(Column::text("robots"));
        let mut table = Table::new(
            format!(
                "{}, {}, with 95 % intervals, estimator {estimator}; bold if significant in the robot's own study.",
                metric.title(),
                criterion_pair_in_words(first, second)
            ),
            columns,
        );
        for row in rows {
            table = table.row(cells(row, vec![Cell::text(&row.condition)]));
        }
        section = section.table(table);
    }
    Ok(section)
}

/// The ratio of a pair under every condition, a colour for each robot.
fn figure(
    summary: &RobotsSummary,
    [first, second]: [&str; 2],
    metric: Metric,
    rows: &[&RobotsComparison],
) -> IntervalFigure {
    let cell = |one: &RobotDifference| {
        one.interval.map(|i| Interval::new(one.difference, i.low.min(one.difference), i.high.max(one.difference)))
    };
    let in_words = criterion_in_words(second);
    let rows: Vec<IntervalRow> = rows
        .iter()
        .map(|row| IntervalRow {
            label: row.condition.clone(),
            cells: row.robots.iter().map(|one| one.as_ref().and_then(cell)).collect(),
        })
        .collect();
    IntervalFigure {
        heading: Heading::new(
            format!(
                "robots-{}-over-{}{}",
                file_stem(first),
                file_stem(second),
                if metric == Metric::Measured { "-measured" } else { "" }
            ),
            titles::pair_on_robots(&criterion_in_words(first), &in_words, &rows),
        )
        .subtitle(format!("{}, estimator {}", metric.title(), summary.shown_estimator()))
        .caption(format!(
            "Ratio of geometric means over designs with its 95 % t interval; left of 1 is better than {in_words}."
        )),
        value: Axis::log(format!("error relative to {in_words}"), ""),
        groups: Group::assign(summary.robots.iter().map(|robot| robot.robot.clone())),
        rows,
        levels: vec![Level::new(1.0, "no difference")],
        band: None,
    }
}

/// Every comparison in every metric.
fn every_score(summary: &RobotsSummary) -> Section {
    let mut columns =
        vec![Column::text("scenario"), Column::text("metric"), Column::text("first"), Column::text("second")];
    columns.extend(summary.robots.iter().map(|robot| Column::number(&robot.robot, "")));
    columns.push(Column::text("robots"));
    let estimator = summary.shown_estimator();
    let mut table = Table::new(
        format!(
            "First over second on each robot (log volume: first minus second) with 95 % intervals, estimator {estimator}; bold if significant in the robot's own study."
        ),
        columns,
    );
    for row in summary.comparisons.iter().filter(|row| row.estimator == estimator) {
        let names = [row.condition.as_str(), row.metric.title(), &row.first, &row.second];
        table = table.row(cells(row, names.map(Cell::text).to_vec()));
    }
    Section::new("Every score on each robot").text(TESTED).table(table)
}

/// What each robot says, behind what the row is about.
fn cells(row: &RobotsComparison, mut cells: Vec<Cell>) -> Vec<Cell> {
    cells.extend(row.robots.iter().map(|one| one.as_ref().map_or(Cell::Missing, |one| Cell::text(written(one)))));
    cells.push(Cell::text(row.agreement.words()));
    cells
}

/// A ratio with its interval, bold where one of the two is better.
fn written(one: &RobotDifference) -> String {
    let interval = one.interval.map_or_else(String::new, |i| format!(" [{:.2}, {:.2}]", i.low, i.high));
    let words = format!("{:.2}{interval}", one.difference);
    if one.better.is_some() { format!("**{words}**") } else { words }
}
