//! The page of a study.

use armid::study::StudyStory;

use super::{atlas, conditions, convergence, criteria, grid, limits, overview, paper, parameters, prediction, rounds};
use crate::{Document, DocumentError};

/// Families of designs that a figure tells apart by their colours.
pub(super) const GROUPS: usize = 8;

/// The page of a study with every figure and table.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn from what is stored.
pub fn study_document(story: &StudyStory) -> Result<Document, DocumentError> {
    let result = &story.result;
    let plan = &result.plan;
    let runs: usize = result.findings().families.iter().filter(|f| is_first(result, f)).map(|f| f.runs).sum();
    let mut document = Document::new(&plan.question)
        .subtitle(format!(
            "{} on {}: {} designs, {} runs, seed {}",
            plan.name,
            arms(&result.plan.engines),
            result.designs.len(),
            runs,
            plan.seed.value()
        ))
        .section(overview::section(story));
    if let Some(rounds) = rounds::section(story)? {
        document = document.section(rounds);
    }
    let is_crowded = plan.designs.len() > GROUPS;
    if grid::is_grid(story) {
        document = document.section(grid::section(story)?);
    } else if !is_crowded {
        document = document.section(criteria::section(story)?);
    }
    if let Some(found) = &result.atlas {
        document = document.section(atlas::section(story, found)?);
    }
    for paragraph in overview::summary(story) {
        document = document.summary(paragraph);
    }
    if let Some(section) = conditions::section(story)? {
        document = document.section(section);
    }
    if let Some(paper) = &result.paper {
        document = document.section(paper::claims(paper)).section(paper::table(paper));
    }
    document = document.section(limits::section(story)?);
    // Hundreds of lines and boxes show nothing: a grid has its tables.
    if !grid::is_grid(story) {
        document = document.section(convergence::section(story)?);
    }
    if !is_crowded {
        document = document.section(parameters::section(story)?);
    }
    document = document.section(prediction::section(story)?);
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

/// The estimator that figures show: the last of the plan, which is the one that knows most.
pub(super) fn shown_estimator(story: &StudyStory) -> &str {
    story.result.plan.identification.estimators.last().map_or("", String::as_str)
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
