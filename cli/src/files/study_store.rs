//! The files of a study: rows as Parquet, the plan as run, the summary, the designs, the report.
//!
//! Wall times and the date are in `timing.parquet` and `provenance.json` alone; everything else is the same bytes for
//! the same plan and seed.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use armid::study::{Examples, Outcome, StudyPlan, StudyResult, StudyStory};
use armid_reports::study_document;
use miette::Result;

use super::parquet_table::{Column, ParquetTable};
use crate::atomic_file::{read_text, write, write_text};
use crate::fault::Fault;

const SUMMARY: &str = "summary.json";
const EXAMPLES: &str = "examples.json";

/// Everything that decides a study's rows, as a text whose hash says whether stored work belongs to it.
pub(crate) fn plan_text(plan: &StudyPlan) -> Result<String> {
    toml::to_string_pretty(plan).map_err(|error| Fault::new(format!("the plan cannot be written: {error}")).into())
}

/// Stores the rows, the plan, the designs, the summary and the examples.
pub(crate) fn write_study(folder: &Path, story: &StudyStory, outcomes: &[Outcome]) -> Result<()> {
    let result = &story.result;
    write_table(&folder.join("runs.parquet"), &run_rows(result, outcomes))?;
    write_table(&folder.join("parameters.parquet"), &parameter_rows(result, outcomes))?;
    write_text(&folder.join("study.toml"), &plan_text(&result.plan)?)?;
    for design in &result.designs {
        let family = &result.plan.designs[design.family].name;
        let text = design.trajectory.to_toml();
        write_text(&folder.join("designs").join(format!("{family}-{}.toml", design.start)), &text)?;
    }
    write_text(&folder.join(EXAMPLES), &json(&story.examples)?)?;
    write_text(&folder.join(SUMMARY), &json(result)?)
}

/// Reads a stored study again.
pub(crate) fn read_study(folder: &Path) -> Result<StudyStory> {
    let summary = read_text(&folder.join(SUMMARY))?;
    let examples = read_text(&folder.join(EXAMPLES))?;
    let fault = |text: &crate::fault::Text, error: &serde_json::Error| {
        Fault::new(format!("no stored study of this version: {error}")).at_line(text, error.line(), error.column())
    };
    let result: StudyResult = serde_json::from_str(&summary.content).map_err(|error| fault(&summary, &error))?;
    let examples: Examples = serde_json::from_str(&examples.content).map_err(|error| fault(&examples, &error))?;
    Ok(StudyStory { result, examples })
}

/// Draws the report of a study; returns the page.
pub(crate) fn write_report(folder: &Path, story: &StudyStory) -> Result<PathBuf> {
    let fault = |error: armid_reports::DocumentError| Fault::new(format!("the report cannot be drawn: {error}"));
    let document = study_document(story).map_err(fault)?;
    let page = folder.join("report.html");
    for (name, svg) in document.svg_files().map_err(fault)? {
        write_text(&folder.join(name), svg)?;
    }
    write_text(&page, &document.html().map_err(fault)?)?;
    Ok(page)
}

/// Stores what differs from one run to the next: seconds, the date, the machine's threads.
pub(crate) fn write_timing(
    folder: &Path,
    design_seconds: &[f64],
    outcomes: &[Outcome],
    run_seconds: &[f64],
) -> Result<()> {
    let designs = design_seconds.len();
    let index = |value: usize| i64::try_from(value).unwrap_or(i64::MAX);
    let kind = std::iter::repeat_n("design".to_owned(), designs).chain(outcomes.iter().map(|_| "run".to_owned()));
    let design = (0..designs).map(index).chain(outcomes.iter().map(|o| index(o.design)));
    let condition = std::iter::repeat_n(-1, designs).chain(outcomes.iter().map(|o| index(o.condition)));
    let run = std::iter::repeat_n(-1, designs).chain(outcomes.iter().map(|o| o.run.cast_signed()));
    let seconds = design_seconds.iter().chain(run_seconds).map(|&s| Some(s));
    let table = ParquetTable::default()
        .with("kind", Column::Text(kind.collect()))
        .with("design", Column::Integer(design.collect()))
        .with("condition", Column::Integer(condition.collect()))
        .with("run", Column::Integer(run.collect()))
        .with("seconds", Column::Number(seconds.collect()));
    write_table(&folder.join("timing.parquet"), &table)?;
    let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let provenance = serde_json::json!({
        "armid": env!("CARGO_PKG_VERSION"),
        "finished_unix_s": unix_s,
        "threads": rayon::current_num_threads(),
        "operating_system": std::env::consts::OS,
        "architecture": std::env::consts::ARCH,
    });
    write_text(&folder.join("provenance.json"), &crate::console::pretty(&provenance))
}

fn json<T: serde::Serialize>(value: &T) -> Result<String> {
    let mut text = serde_json::to_string(value).map_err(|error| Fault::new(format!("a result: {error}")))?;
    text.push('\n');
    Ok(text)
}

fn write_table(path: &Path, table: &ParquetTable) -> Result<()> {
    write(path, |out| table.write(out).map_err(std::io::Error::other))
}

/// One row per run, design and estimator.
fn run_rows(result: &StudyResult, outcomes: &[Outcome]) -> ParquetTable {
    let (mut family, mut design, mut run, mut estimator) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut condition, mut made_of) = (Vec::new(), Vec::new());
    let (mut status, mut reason) = (Vec::new(), Vec::new());
    let (mut prediction, mut of_rating, mut reference) = (Vec::new(), Vec::new(), Vec::new());
    let mut residual: Vec<Vec<Option<f64>>> = vec![Vec::new(); result.joints.len()];
    for outcome in outcomes {
        for (e, name) in result.plan.identification.estimators.iter().enumerate() {
            let estimate = outcome.estimates.get(e);
            let score = estimate.and_then(|estimate| estimate.score.as_ref());
            let failure = outcome.failure.as_ref().or_else(|| estimate.and_then(|estimate| estimate.failure.as_ref()));
            family.push(result.plan.designs[result.designs[outcome.design].family].name.clone());
            design.push(i64::try_from(outcome.design).unwrap_or(i64::MAX));
            run.push(outcome.run.cast_signed());
            estimator.push(name.clone());
            condition.push(result.conditions[outcome.condition].condition.name.clone());
            made_of.push(truth_name(outcome));
            status.push(failure.map_or("ok", |failure| failure.kind.name()).to_owned());
            reason.push(failure.map_or_else(String::new, |failure| failure.reason.clone()));
            prediction.push(score.map(|s| s.prediction_rmse_nm));
            of_rating.push(score.map(|s| s.prediction_rmse_of_rating));
            reference.push(score.map(|s| s.reference_rmse));
            for (j, column) in residual.iter_mut().enumerate() {
                column.push(estimate.and_then(|estimate| estimate.residual_rms.get(j).copied()));
            }
        }
    }
    const RESIDUALS: [&str; 8] = [
        "residual_rms_1",
        "residual_rms_2",
        "residual_rms_3",
        "residual_rms_4",
        "residual_rms_5",
        "residual_rms_6",
        "residual_rms_7",
        "residual_rms_8",
    ];
    let table = ParquetTable::default()
        .with("family", Column::Text(family))
        .with("design", Column::Integer(design))
        .with("run", Column::Integer(run))
        .with("condition", Column::Text(condition))
        .with("truth", Column::Text(made_of))
        .with("estimator", Column::Text(estimator))
        .with("status", Column::Text(status))
        .with("reason", Column::Text(reason))
        .with("prediction_rmse_nm", Column::Number(prediction))
        .with("prediction_rmse_of_rating", Column::Number(of_rating))
        .with("reference_rmse", Column::Number(reference));
    residual.into_iter().zip(RESIDUALS).fold(table, |table, (column, name)| table.with(name, Column::Number(column)))
}

/// What the arm of a run was made of.
fn truth_name(outcome: &Outcome) -> String {
    if outcome.truth == 0 { "robot".to_owned() } else { format!("draw {}", outcome.truth) }
}

/// One row per run, design, estimator and parameter.
fn parameter_rows(result: &StudyResult, outcomes: &[Outcome]) -> ParquetTable {
    let (mut run, mut design, mut estimator, mut parameter) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut condition, mut made_of) = (Vec::new(), Vec::new());
    let (mut truth, mut estimate, mut std, mut half_width) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for outcome in outcomes {
        for scored in outcome.estimates.iter().filter(|scored| scored.score.is_some()) {
            for (i, line) in result.parameters.iter().enumerate() {
                run.push(outcome.run.cast_signed());
                design.push(i64::try_from(outcome.design).unwrap_or(i64::MAX));
                condition.push(result.conditions[outcome.condition].condition.name.clone());
                estimator.push(scored.estimator.clone());
                parameter.push(line.name.clone());
                made_of.push(truth_name(outcome));
                truth.push(Some(result.truth(outcome.truth, i)));
                estimate.push(Some(scored.beta[i]));
                std.push(Some(scored.std[i]));
                half_width.push(Some(scored.half_width[i]));
            }
        }
    }
    let rows = run.len();
    ParquetTable::default()
        .with("run", Column::Integer(run))
        .with("design", Column::Integer(design))
        .with("condition", Column::Text(condition))
        .with("estimator", Column::Text(estimator))
        .with("noise", Column::Text(vec!["robot".to_owned(); rows]))
        .with("truth", Column::Text(made_of))
        .with("parameter", Column::Text(parameter))
        .with("true", Column::Number(truth))
        .with("estimate", Column::Number(estimate))
        .with("std", Column::Number(std))
        .with("half_width", Column::Number(half_width))
}
