//! The page of a study.

use armid::study::ReportInput;

use super::selection::GROUPS;
use super::{
    conditions, convergence, correlations, criteria, effect_levels, effect_sensitivity, estimators, grid, limits,
    motions, overview, parameters, prediction, radkhah2007, rounds,
};
use crate::{Document, DocumentError};

/// The page of a study with every figure and table.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn from what is stored.
pub fn study_document(input: &ReportInput) -> Result<Document, DocumentError> {
    let result = &input.result;
    let plan = &result.plan;
    let runs: usize = result.findings().families.iter().filter(|f| is_first(result, f)).map(|f| f.runs).sum();
    let mut document = Document::new(&plan.question)
        .subtitle(format!(
            "{} on {}: {} designs, {} runs{}, seed {}",
            plan.name,
            arms(&result.plan.engines),
            result.designs.len(),
            runs,
            if result.conditions.len() > 1 {
                format!(" in each of {} scenarios", result.conditions.len())
            } else {
                String::new()
            },
            plan.seed.value()
        ))
        .section(overview::section(input))
        .section(motions::section(input));
    if let Some(rounds) = rounds::section(input)? {
        document = document.section(rounds);
    }
    let is_crowded = plan.designs.len() > GROUPS;
    if grid::is_grid(input) {
        document = document.section(grid::section(input)?);
    } else if !is_crowded {
        document = document.section(criteria::section(input)?);
    }
    if let Some(section) = correlations::section(input) {
        document = document.section(section);
    }
    if let Some(found) = &result.effect_sensitivity {
        document = document.section(effect_sensitivity::section(input, found)?);
    }
    if let Some(section) = estimators::section(input)? {
        document = document.section(section);
    }
    for paragraph in result.answer() {
        document = document.summary(paragraph);
    }
    if let Some(section) = effect_levels::section(input)? {
        document = document.section(section);
    }
    if let Some(section) = conditions::section(input)? {
        document = document.section(section);
    }
    if let Some(found) = &result.radkhah2007 {
        document = document.section(radkhah2007::claims(found)).section(radkhah2007::table(found));
    }
    document = document.section(limits::section(input)?);
    // Hundreds of lines and boxes show nothing: a grid has its tables.
    if !grid::is_grid(input) {
        document = document.section(convergence::section(input)?);
    }
    if !is_crowded {
        document = document.section(parameters::section(input)?);
    }
    document = document.section(prediction::section(input)?);
    Ok(document
        .provenance("armid", &result.provenance.version)
        .provenance(
            "robot",
            format!("{}, SHA-256 of its file {}", result.provenance.robot, result.provenance.robot_sha256),
        )
        .provenance("seed", plan.seed.value().to_string())
        .provenance(
            "experiment",
            format!(
                "{} periods of {} s recorded at {} Hz after {} discarded",
                plan.experiment.periods,
                plan.experiment.period_s,
                plan.experiment.rate_hz,
                plan.experiment.discarded_periods
            ),
        )
        .provenance(
            "identification",
            format!(
                "{} columns, derivatives by {}, {} samples of the mean period",
                plan.identification.columns, plan.identification.derivatives, plan.identification.samples_per_period
            ),
        ))
}

/// The simulated arms, in words.
fn arms(engines: &[String]) -> String {
    match engines {
        [one] => format!("the {one} arm"),
        [some @ .., last] => format!("the {} and {last} arms", some.join(", ")),
        [] => "no arm".to_owned(),
    }
}

fn is_first(result: &armid::study::StudyResult, score: &armid::study::FamilyScore) -> bool {
    result.plan.identification.estimators.first() == Some(&score.estimator)
}
