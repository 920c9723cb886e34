//! Criteria relative to one of them by the size of an unmodelled effect: a figure of each effect, and where the lead of that one ends.

use armid::study::{EffectLevels, Lead, LevelRatios, Metric, ReportInput, RobotDifference, criterion_in_words};

use crate::{Cell, Column, DocumentError, Group, Heading, Interval, LevelFigure, LevelPanel, Section, Table};

/// Groups of designs that have a curve, and metrics that have a panel. A figure has room for three: where all are there, the second gives way.
const CURVES: [&str; 4] = ["condition", "d-optimal, equal speed", "i-optimal", "measured-torque"];
const PANELS: [(Metric, &str); 2] =
    [(Metric::Prediction, "predicted torque of the arm without the effect"), (Metric::Measured, "measured torque")];

/// Errors relative to those of the reference over the size of one effect, by predicted and by measured torque.
pub fn levels_figure(levels: &EffectLevels) -> LevelFigure {
    let of = |criterion: &str, metric: Metric| {
        levels.ratios.iter().find(|ratios| ratios.criterion == criterion && ratios.metric == metric)
    };
    let panels: Vec<(Metric, &str)> =
        PANELS.into_iter().filter(|(metric, _)| levels.ratios.iter().any(|ratios| ratios.metric == *metric)).collect();
    let is_complete = |criterion: &&str| panels.iter().all(|(metric, _)| of(criterion, *metric).is_some());
    let mut criteria: Vec<&str> = CURVES.into_iter().filter(is_complete).collect();
    if criteria.len() == CURVES.len() {
        criteria.remove(1);
    }
    let reference = criterion_in_words(&levels.reference);
    let effect = levels.effect.replace('-', " ");
    let first = criteria.first().and_then(|criterion| of(criterion, Metric::Prediction));
    let name = format!("levels-{}-{}", levels.robot, levels.effect).to_lowercase();
    let name = name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "-");
    LevelFigure {
        heading: Heading::new(name, title(levels, first, &reference, &effect))
            .subtitle(format!(
                "Error relative to {reference} designs, {}. Bands: 95 % intervals.",
                levels.robot.to_uppercase().replace('-', " ")
            ))
            .caption(format!(
                "Torque error relative to {reference} designs ({} of each criterion) over the size of {effect} that the model omits; \
                 below 1 is better.",
                levels.designs
            )),
        label: format!(
            "{effect} that the model omits{} (0, then a logarithmic axis)",
            if levels.effect.contains(" and ") { ", of realistic" } else { "" }
        ),
        groups: Group::assign(criteria.iter().map(|criterion| criterion_in_words(criterion))),
        sizes: levels.sizes.iter().map(|&size| (size, size_in_words(size, &levels.unit, 3))).collect(),
        panels: panels
            .iter()
            .map(|(metric, title)| LevelPanel {
                title: (*title).to_owned(),
                curves: criteria.iter().filter_map(|criterion| of(criterion, *metric)).map(curve).collect(),
                mark: criteria.first().and_then(|criterion| of(criterion, *metric)).and_then(|ratios| match ratios.lead {
                    Lead::Ends { size, .. } if *metric == Metric::Prediction => {
                        Some((size, format!("equal at {}", size_in_words(size, &levels.unit, 2))))
                    }
                    _ => None,
                }),
            })
            .collect(),
        reference,
    }
}

/// What the first curve does.
fn title(levels: &EffectLevels, first: Option<&LevelRatios>, reference: &str, effect: &str) -> String {
    let Some(first) = first else { return format!("{reference} designs are compared with none") };
    let criterion = criterion_in_words(&first.criterion).replace(' ', "-");
    match first.lead {
        Lead::None => format!("{reference} designs have no lead over {criterion} ones, whatever the {effect}"),
        Lead::Remains => format!("{reference} designs beat {criterion} ones at every size of {effect}"),
        Lead::Ends { size, .. } => format!(
            "{reference} designs beat {criterion} ones only below {} {effect}",
            size_in_words(size, &levels.unit, 2)
        ),
    }
}

/// A ratio without an interval has a band of no width.
fn curve(ratios: &LevelRatios) -> Vec<Interval> {
    let point = |error: &RobotDifference| {
        let (low, high) = error.interval.map_or((error.difference, error.difference), |i| (i.low, i.high));
        Interval::new(error.difference, low.min(error.difference), high.max(error.difference))
    };
    ratios.errors.iter().map(point).collect()
}

/// A section with a figure of each effect and a row of each in a table, where a study has sizes of effects.
pub(super) fn section(input: &ReportInput) -> Result<Option<Section>, DocumentError> {
    let all = EffectLevels::from_result(&input.result);
    let Some(first) = all.first() else { return Ok(None) };
    let reference = criterion_in_words(&first.reference);
    let mut section = Section::new("From which size of an effect on?").text(format!(
        "Where the lead of {reference} designs ends, as an effect that the model omits grows. In brackets: sizes at which \
         the interval of the ratio holds 1."
    ));
    let mut columns = Column::list("effect | score");
    let mut criteria: Vec<&str> = Vec::new();
    for ratios in &first.ratios {
        if !criteria.contains(&ratios.criterion.as_str()) {
            criteria.push(&ratios.criterion);
        }
    }
    columns.extend(criteria.iter().map(|criterion| Column::text(criterion_in_words(criterion))));
    let mut table = Table::new(format!("Size at which the lead of {reference} designs ends, by criterion."), columns);
    for levels in &all {
        for metric in [Metric::Prediction, Metric::Measured, Metric::Reference] {
            let lead = |criterion: &&str| {
                let of = levels.ratios.iter().find(|r| r.criterion == **criterion && r.metric == metric);
                of.map_or_else(|| "–".to_owned(), |ratios| lead_in_words(ratios.lead, &levels.unit))
            };
            if levels.ratios.iter().any(|ratios| ratios.metric == metric) {
                let names = [Cell::text(levels.effect.replace('-', " ")), Cell::text(metric.title())];
                table = table.row(names.into_iter().chain(criteria.iter().map(lead).map(Cell::text)).collect());
            }
        }
    }
    section = section.table(table);
    for levels in &all {
        section = section.figure(&levels_figure(levels))?;
    }
    Ok(Some(section))
}

fn lead_in_words(lead: Lead, unit: &str) -> String {
    match lead {
        Lead::None => "no lead".to_owned(),
        Lead::Remains => "at none of these".to_owned(),
        Lead::Ends { size, low, high } => {
            let high = high.map_or_else(|| "beyond".to_owned(), |high| size_in_words(high, unit, 2));
            format!("{} [{}, {high}]", size_in_words(size, unit, 2), size_in_words(low, unit, 2))
        }
    }
}

/// A size with its unit, a share in percent, to so many significant digits.
fn size_in_words(size: f64, unit: &str, digits: i32) -> String {
    let (value, unit) = if unit.is_empty() { (100.0 * size, "%") } else { (size, unit) };
    if value <= 0.0 {
        return format!("0 {unit}");
    }
    let decimals = (digits - 1 - libm::floor(libm::log10(value)) as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {unit}")
}

#[cfg(test)]
mod tests {
    use super::size_in_words;

    #[test]
    fn sizes_in_words() {
        for (size, unit, digits, words) in [
            (0.0, "", 2, "0 %"),
            (0.000_357, "", 2, "0.036 %"),
            (0.0125, "", 3, "1.25 %"),
            (0.05, "", 3, "5 %"),
            (2.0, "mrad", 3, "2 mrad"),
            (0.361, "mrad", 2, "0.36 mrad"),
            (1.0, "", 3, "100 %"),
        ] {
            assert_eq!(size_in_words(size, unit, digits), words);
        }
    }
}
