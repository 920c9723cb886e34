//! The front figure: two criteria relative to a third, effect by effect, on several robots.

use armid::study::{CriterionRatios, capitalised, criterion_in_words};

use crate::{Group, Heading, Interval, Ratio, RatioFigure, RatioPanel};

/// Effects that are shown: with the exact model six rows, which for two criteria on two robots are 24 marks.
const EFFECTS: usize = 5;

/// Criteria relative to one of them, a panel for each robot.
///
/// Rows are the exact model and the five single effects that move the first criterion furthest from the reference on the first
/// robot, by the logarithm of the ratio. On that robot every effect that is left out is closer to 1 than these, so that none
/// of them extends the range of answers. Effects are sorted by that ratio, the largest first.
pub fn criteria_figure(robots: &[CriterionRatios]) -> RatioFigure {
    let first = robots.first();
    let (mut criteria, mut effects): (Vec<&str>, Vec<Option<&str>>) = (Vec::new(), Vec::new());
    for ratio in first.into_iter().flat_map(|robot| &robot.ratios) {
        if !criteria.contains(&ratio.criterion.as_str()) {
            criteria.push(&ratio.criterion);
        }
        if !effects.contains(&ratio.effect.as_deref()) {
            effects.push(ratio.effect.as_deref());
        }
    }
    let everywhere = |effect: &Option<&str>| {
        robots.iter().all(|robot| criteria.iter().all(|criterion| found(robot, *effect, criterion).is_some()))
    };
    effects.retain(everywhere);
    let of_first = |effect: Option<&str>| {
        let ratio = first.zip(criteria.first()).and_then(|(robot, criterion)| found(robot, effect, criterion));
        libm::log(ratio.map_or(1.0, |ratio| ratio.interval.point))
    };
    // The exact model stays first in both orders.
    let by =
        |key: &dyn Fn(f64) -> f64, effect: Option<&str>| effect.map_or(f64::NEG_INFINITY, |_| key(of_first(effect)));
    effects.sort_by(|a, b| by(&|log| -log.abs(), *a).total_cmp(&by(&|log| -log.abs(), *b)));
    effects.truncate(EFFECTS + usize::from(effects.contains(&None)));
    effects.sort_by(|a, b| by(&|log| -log, *a).total_cmp(&by(&|log| -log, *b)));

    let reference = first.map_or_else(String::new, |robot| criterion_in_words(&robot.reference));
    let panel = |robot: &CriterionRatios| RatioPanel {
        title: robot.robot.to_uppercase().replace('-', " "),
        subtitle: format!("{} designs per criterion", robot.designs),
        cells: effects.iter().map(|effect| criteria.iter().map(|c| found(robot, *effect, c)).collect()).collect(),
    };
    let panels: Vec<RatioPanel> = robots.iter().map(panel).collect();
    let names: Vec<String> = criteria.iter().map(|criterion| criterion_in_words(criterion)).collect();
    RatioFigure {
        heading: Heading::new("criteria", title(&names, &reference, &panels))
            .subtitle("Each row: one effect that the model omits. Bars: 95 % intervals.")
            .caption(format!(
                "Torque prediction error on random motions relative to {reference} designs; left of 1 is better. Hollow: adjusted p is at least 0.05."
            )),
        label: format!("torque error relative to {reference} designs"),
        reference,
        groups: Group::assign(names),
        rows: effects.into_iter().map(effect_in_words).collect(),
        panels,
    }
}

fn found(robot: &CriterionRatios, effect: Option<&str>, criterion: &str) -> Option<Ratio> {
    let ratio = robot.ratios.iter().find(|ratio| ratio.effect.as_deref() == effect && ratio.criterion == criterion)?;
    let interval = ratio.error.interval?;
    let interval = Interval::new(ratio.error.difference, interval.low, interval.high);
    Some(Ratio { interval, is_significant: ratio.error.better.is_some() })
}

/// What the marks show: whether any is significant, which criterion has the smallest error in most rows, and whether in all.
fn title(criteria: &[String], reference: &str, panels: &[RatioPanel]) -> String {
    let mut wins = vec![0; criteria.len() + 1];
    let rows = panels.iter().flat_map(|panel| &panel.cells);
    for row in rows.clone() {
        let points = row.iter().map(|cell| cell.map_or(f64::INFINITY, |ratio| ratio.interval.point)).chain([1.0]);
        if let Some((best, _)) = points.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b)) {
            wins[best] += 1;
        }
    }
    let most = wins.iter().copied().max().unwrap_or(0);
    let best = wins.iter().position(|&count| count == most).and_then(|index| criteria.get(index));
    let best = best.map_or(reference, String::as_str);
    if !rows.clone().flatten().flatten().any(|ratio| ratio.is_significant) {
        "No difference between excitation criteria is significant".to_owned()
    } else if most == rows.count() {
        format!("{} designs predict torque best in every row", capitalised(best))
    } else {
        format!("No excitation criterion wins everywhere; {best} comes closest")
    }
}

/// An effect as the name of a row.
pub(super) fn effect_in_words(effect: Option<&str>) -> String {
    match effect {
        None => "exact model",
        Some("elasticity") => "elastic joints",
        Some("load-friction") => "friction that grows with load",
        Some("stribeck") => "Stribeck friction",
        Some("warming") => "gear that warms up",
        Some(other) => return other.replace('-', " "),
    }
    .to_owned()
}
