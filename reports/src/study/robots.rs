//! The page of one study on several robots: what one robot says, beside what the others say.

use armid::study::{Agreement, Metric, RobotDifference, RobotsComparison, RobotsSummary};

use super::overview::TESTED;
use super::selection::GROUPS;
use crate::{
    Axis, Cell, Column, Document, DocumentError, Group, Heading, Interval, IntervalFigure, IntervalRow, Level, Section,
    Table,
};

/// Metrics that the answer tells of.
const TOLD: [Metric; 2] = [Metric::Prediction, Metric::Measured];

/// The page of one study on several robots, with the answer, every comparison robot by robot, and links to the pages of the
/// robots.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn from what is stored.
pub fn robots_document(summary: &RobotsSummary) -> Result<Document, DocumentError> {
    let robots: Vec<&str> = summary.robots.iter().map(|robot| robot.robot.as_str()).collect();
    let mut document = Document::new(&summary.question).subtitle(format!(
        "{} on {}, {} conditions on each",
        summary.name,
        robots.join(", "),
        summary.conditions.len()
    ));
    for paragraph in robots_answer(summary) {
        document = document.summary(paragraph);
    }
    document = document.section(pages(summary));
    let pairs = pairs(summary);
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

/// The answer in paragraphs: whether what is decided on one robot is so on the others, then pair by pair.
#[must_use]
pub fn robots_answer(summary: &RobotsSummary) -> Vec<String> {
    let estimator = shown_estimator(summary);
    let mut paragraphs = Vec::new();
    for metric in TOLD {
        let counts = summary.agreements.iter().find(|c| c.metric == metric && c.estimator == estimator);
        let Some(counts) = counts else { continue };
        let [same, in_part, reversed, undecided, alone] = Agreement::ALL.map(|agreement| counts.of(agreement));
        let decided = same + in_part + reversed;
        let mut words = format!(
            "**By {}, of {decided} comparisons that a robot decides {same} are decided the same way on every robot, {in_part} on some robots alone and {reversed} are turned round on another.** Undecided on every robot: {undecided}.",
            metric.title()
        );
        if alone > 0 {
            words += &format!(" Compared on one robot alone: {alone}.");
        }
        paragraphs.push(words);
    }
    for pair in pairs(summary) {
        paragraphs.extend(sentence(summary, pair, estimator));
    }
    paragraphs
}

/// Under how many conditions, and which, the robots agree on a pair of families by the first metric.
fn sentence(summary: &RobotsSummary, [first, second]: [&str; 2], estimator: &str) -> Option<String> {
    let rows = rows(summary, [first, second], Metric::Prediction, estimator);
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
    let named = |agreement: Agreement| -> String {
        let of = rows.iter().filter(|row| row.agreement == agreement);
        let names: Vec<&str> = of.map(|row| row.condition.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { format!("{} ({})", names.len(), names.join("; ")) }
    };
    let alone = rows.iter().filter(|row| row.agreement == Agreement::OneRobot).count();
    if alone == rows.len() {
        return Some(format!("{first} against {second} is compared on one robot alone."));
    }
    Some(format!(
        "{first} against {second}: better on every robot under {better} of {} conditions, worse on every robot under {worse}; turned round: {}; decided on some robots alone: {}; undecided on every robot: {}.",
        rows.len(),
        named(Agreement::Reversed),
        named(Agreement::InPart),
        named(Agreement::Undecided),
    ))
}

/// Where the page of each robot is, and what stands behind it.
fn pages(summary: &RobotsSummary) -> Section {
    let columns = vec![
        Column::text("robot"),
        Column::number("base parameters", ""),
        Column::number("designs", ""),
        Column::number("runs", ""),
    ];
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

/// A pair of families on every robot, condition by condition.
fn of_pair(summary: &RobotsSummary, pair: [&str; 2]) -> Result<Section, DocumentError> {
    let [first, second] = pair;
    let estimator = shown_estimator(summary);
    let rows = rows(summary, pair, Metric::Prediction, estimator);
    let mut section = Section::new(format!("{first} against {second}"));
    let figure = figure(summary, pair, &rows);
    if figure.rows.iter().any(|row| row.cells.iter().any(Option::is_some)) {
        section = section.figure(&figure)?;
    }
    let mut columns = vec![Column::text("condition")];
    columns.extend(summary.robots.iter().map(|robot| Column::number(&robot.robot, "")));
    columns.push(Column::text("robots"));
    let mut table = Table::new(
        format!(
            "{}, {first} over {second}, with 95 % intervals, estimator {estimator}; bold where the robot's own study calls one better.",
            Metric::Prediction.title()
        ),
        columns,
    );
    for row in rows {
        table = table.row(cells(row, vec![Cell::text(&row.condition)]));
    }
    Ok(section.table(table))
}

/// The ratio of a pair under every condition, a colour for each robot.
fn figure(summary: &RobotsSummary, [first, second]: [&str; 2], rows: &[&RobotsComparison]) -> IntervalFigure {
    let cell = |one: &RobotDifference| {
        one.interval.map(|i| Interval::new(one.difference, i.low.min(one.difference), i.high.max(one.difference)))
    };
    IntervalFigure {
        heading: Heading::new(
            format!("robots-{}-over-{}", slug(first), slug(second)),
            format!("{first} against {second} on each robot"),
        )
        .subtitle(format!("{}, estimator {}", Metric::Prediction.title(), shown_estimator(summary)))
        .caption(format!(
            "Ratio of geometric means over designs with its 95 % t interval; left of 1 {first} is better than {second}."
        )),
        value: Axis::log(format!("ratio to {second}"), ""),
        groups: Group::assign(summary.robots.iter().map(|robot| robot.robot.clone())),
        rows: rows
            .iter()
            .map(|row| IntervalRow {
                label: row.condition.clone(),
                cells: row.robots.iter().map(|one| one.as_ref().and_then(cell)).collect(),
            })
            .collect(),
        levels: vec![Level::new(1.0, "no difference")],
        band: None,
    }
}

/// Every comparison in every metric.
fn every_score(summary: &RobotsSummary) -> Section {
    let mut columns =
        vec![Column::text("condition"), Column::text("metric"), Column::text("first"), Column::text("second")];
    columns.extend(summary.robots.iter().map(|robot| Column::number(&robot.robot, "")));
    columns.push(Column::text("robots"));
    let estimator = shown_estimator(summary);
    let mut table = Table::new(
        format!(
            "First over second on each robot (log volume: first minus second) with 95 % intervals, estimator {estimator}; bold where the robot's own study calls one better."
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

/// Pairs of families, in the order in which they were found.
fn pairs(summary: &RobotsSummary) -> Vec<[&str; 2]> {
    let mut pairs: Vec<[&str; 2]> = Vec::new();
    for row in &summary.comparisons {
        let pair = [row.first.as_str(), row.second.as_str()];
        if !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    pairs
}

/// A pair in one metric under every condition.
fn rows<'a>(
    summary: &'a RobotsSummary,
    [first, second]: [&str; 2],
    metric: Metric,
    estimator: &str,
) -> Vec<&'a RobotsComparison> {
    let all = summary.comparisons.iter();
    all.filter(|row| row.metric == metric && row.estimator == estimator && row.first == first && row.second == second)
        .collect()
}

/// The estimator that is shown: the last of the plan that was compared.
fn shown_estimator(summary: &RobotsSummary) -> &str {
    let compared = |name: &&String| summary.agreements.iter().any(|counts| counts.estimator == **name);
    summary.estimators.iter().rev().find(compared).map_or("", String::as_str)
}

/// A name as a part of a file's name.
fn slug(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    name.chars().map(letter).collect()
}
