//! The sensitivity: what every effect of the real arm does to the estimates.

use armid::experiment::Level;
use armid::study::{EffectSensitivity, ReportInput, SensitivityEntry, capitalised, criterion_in_words};

use super::criteria_on_robots::effect_in_words;
use super::titles;
use crate::heading::file_stem;
use crate::{Axis, Cell, ColourMap, Column, DocumentError, Heading, HeatFigure, Section, Table};

/// Biases below this many standard deviations are drawn as this many: they are invisible.
const LEAST_STD: f64 = 0.3;

/// The figures and tables of the effects.
pub(super) fn section(input: &ReportInput, sensitivity: &EffectSensitivity) -> Result<Section, DocumentError> {
    let plan = &input.result.plan;
    // Of several families one is shown: the one that all are compared with, or the first.
    let family = plan.compare_with.first().or(plan.designs.first().map(|design| &design.name));
    let mut sensitivity = sensitivity.clone();
    sensitivity.entries.retain(|entry| Some(&entry.family) == family);
    let sensitivity = &sensitivity;
    let of = |estimator: &str| -> Vec<&SensitivityEntry> {
        sensitivity.entries.iter().filter(|entry| entry.estimator == estimator && entry.runs > 0).collect()
    };
    let mut section = Section::new("Effect sensitivity")
        .text("Every effect alone, or several at once, on otherwise the same arm, with the same designs and the same random numbers. The true parameters are those of the arm without the effect. An error ratio of 1 means that the effect is lost in the noise of the measurement.");
    if let (true, Some(family)) = (plan.designs.len() > 1, family) {
        section = section.text(format!("Shown are the {} designs.", criterion_in_words(family)));
    }
    // The estimator that figures show comes first.
    let mut without: Vec<&str> = Vec::new();
    for estimator in input.result.plan.identification.estimators.iter().rev() {
        let shown = of(estimator);
        if shown.is_empty() {
            without.insert(0, estimator);
        } else {
            section = section.figure(&glance(input, sensitivity, &shown, estimator))?;
        }
    }
    if !without.is_empty() {
        section = section.text(format!("No run with an effect gave an estimate by {}.", without.join(", ")));
    }
    let estimator = input.result.shown_estimator();
    let shown = of(estimator);
    if !shown.is_empty() {
        section = section.figure(&biases(input, &shown, estimator))?;
    }
    Ok(section.table(predictions(sensitivity)).table(worst(input, sensitivity)))
}

/// The level of a condition: that of its effect, or of all of its effects where they have one.
fn level_of(input: &ReportInput, entry: &SensitivityEntry) -> Option<Level> {
    let of_all = || {
        let conditions = &input.result.conditions;
        let result = conditions.iter().find(|result| result.condition.name == entry.condition)?;
        let mut levels = result.condition.effects.iter().map(|(kind, magnitude)| kind.level(magnitude));
        let first = levels.next()??;
        levels.all(|level| level == Some(first)).then_some(first)
    };
    if entry.effect.is_some() { entry.level } else { of_all() }
}

/// The effects, each once, those that raise the prediction error most at their first level first.
fn effects<'a>(shown: &[&'a SensitivityEntry]) -> Vec<&'a str> {
    let mut found: Vec<(&str, f64)> = Vec::new();
    for entry in shown {
        let name = entry.effect.as_deref().unwrap_or(&entry.condition);
        if !found.iter().any(|(other, _)| *other == name) {
            found.push((name, entry.prediction_ratio.unwrap_or(0.0)));
        }
    }
    found.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    found.into_iter().map(|(name, _)| name).collect()
}

/// One row per effect: the error of prediction and of each kind of parameter at each level.
fn glance(
    input: &ReportInput,
    sensitivity: &EffectSensitivity,
    shown: &[&SensitivityEntry],
    estimator: &str,
) -> HeatFigure {
    let rows = effects(shown);
    let find = |effect: &str, level: Option<Level>| {
        let named = |entry: &&&SensitivityEntry| entry.effect.as_deref().unwrap_or(&entry.condition) == effect;
        shown.iter().filter(named).find(|entry| level_of(input, entry) == level)
    };
    let mut levels: Vec<Option<Level>> = Level::ALL.into_iter().map(Some).chain([None]).collect();
    levels.retain(|&level| shown.iter().any(|entry| level_of(input, entry) == level));
    let names: Vec<String> =
        std::iter::once("prediction").chain(sensitivity.kinds.iter().map(String::as_str)).map(str::to_owned).collect();
    let values = rows.iter().flat_map(|effect| {
        levels.iter().flat_map(|&level| {
            let entry = find(effect, level);
            let prediction = entry.and_then(|entry| entry.prediction_ratio);
            let kinds = (0..sensitivity.kinds.len()).map(move |kind| entry.and_then(|entry| entry.kind_ratios[kind]));
            std::iter::once(prediction).chain(kinds).collect::<Vec<_>>()
        })
    });
    let group =
        |level: &Option<Level>| level.map_or("other magnitudes".to_owned(), |level| format!("{} level", level.name()));
    // The first row has the largest increase.
    let title = rows.first().map_or_else(
        || "Error increase per unmodelled effect".to_owned(),
        |effect| format!("{} raises the error of prediction most", capitalised(&effect_in_words(Some(effect)))),
    );
    HeatFigure {
        heading: Heading::new(format!("atlas-{}", file_stem(estimator)), title)
            .subtitle(format!("error increase per unmodelled effect: how many times the error without the effect, estimator {estimator}"))
            .caption("Rows: one effect alone, or several by the name of their scenario, the largest increase of the prediction error at the top. Prediction: RMSE of predicted torque over the rating. Parameters: root mean square over the parameters of a kind. 1 is an effect that noise hides; grey is a level that was not run, or a run that gave no estimate."),
        values: values.collect(),
        rows: rows.into_iter().map(|effect| effect_in_words(Some(effect))).collect(),
        columns: levels.iter().flat_map(|_| names.clone()).collect(),
        groups: levels.iter().map(|level| (group(level), names.len())).collect(),
        value: Axis::log("times the error without the effect", "").including(&[1.0]),
        colours: ColourMap::Sequential,
        digits: 1,
    }
}

/// One row per condition, one column per base parameter.
fn biases(input: &ReportInput, shown: &[&SensitivityEntry], estimator: &str) -> HeatFigure {
    let names: Vec<String> = input.result.parameters.iter().map(|parameter| parameter.name.clone()).collect();
    let title = titles::biased_most(shown, &names);
    HeatFigure {
        heading: Heading::new("atlas-parameters", title.unwrap_or_else(|| "Which parameter each effect biases".to_owned()))
            .subtitle(format!("size of the bias in standard deviations that the estimator states, estimator {estimator}"))
            .caption(format!("One column per base parameter. A bias of 1 is as large as the error bar beside the estimate; {LEAST_STD} stands for everything below it.")),
        rows: shown.iter().map(|entry| entry.condition.clone()).collect(),
        columns: names,
        groups: Vec::new(),
        values: shown
            .iter()
            .flat_map(|entry| entry.parameters.iter().map(|bias| Some(bias.in_std.abs().max(LEAST_STD))))
            .collect(),
        value: Axis::log("bias", "standard deviations").including(&[1.0]),
        colours: ColourMap::Sequential,
        digits: 0,
    }
}

/// Prediction and kinds of parameters, for every estimator.
fn predictions(sensitivity: &EffectSensitivity) -> Table {
    let mut columns = Column::list(
        "scenario | estimator | what it is | #runs | #failed | #prediction [N·m] | #prediction [ratio] | #low | \
         #high",
    );
    columns.extend(sensitivity.kinds.iter().map(|kind| Column::number(kind, "ratio")));
    let caption = "Every effect with every estimator: torque prediction RMSE (geometric mean over runs), its ratio to the error without the effect with a 95 % interval from runs in pairs, and the error ratio of each kind of parameter.";
    let number = |value: Option<f64>, digits| value.map_or(Cell::Missing, |value| Cell::number(value, digits));
    let mut table = Table::new(caption, columns);
    for entry in &sensitivity.entries {
        let mut row = vec![
            Cell::text(&entry.condition),
            Cell::text(&entry.estimator),
            Cell::text(&entry.meaning),
            Cell::count(entry.runs),
            Cell::count(entry.failures),
            number(entry.prediction_nm, 3),
            number(entry.prediction_ratio, 3),
            number(entry.prediction_interval.map(|i| i.low), 3),
            number(entry.prediction_interval.map(|i| i.high), 3),
        ];
        row.extend(entry.kind_ratios.iter().map(|&ratio| number(ratio, 3)));
        table = table.row(row);
    }
    table
}

/// The three parameters that each effect biases most.
fn worst(input: &ReportInput, sensitivity: &EffectSensitivity) -> Table {
    let mut table = Table::new(
        "The three base parameters that each effect biases most, with 95 % intervals: in standard deviations that the estimator states, and in reference units.",
        Column::list(
            "scenario | estimator | parameter | #bias [std] | #low | #high | #bias [ref. units] | #low | #high",
        ),
    );
    for entry in &sensitivity.entries {
        for &i in entry.worst.iter().take(3) {
            let bias = &entry.parameters[i];
            let end = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::number(value, 3));
            table = table.row(vec![
                Cell::text(&entry.condition),
                Cell::text(&entry.estimator),
                Cell::text(&input.result.parameters[i].name),
                Cell::number(bias.in_std, 3),
                end(bias.in_std_interval.map(|i| i.low)),
                end(bias.in_std_interval.map(|i| i.high)),
                Cell::number(bias.in_units, 3),
                end(bias.in_units_interval.map(|i| i.low)),
                end(bias.in_units_interval.map(|i| i.high)),
            ]);
        }
    }
    table
}
