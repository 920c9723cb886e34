//! The files of a study: rows as Parquet, the plan as run, the summary, the designs.
//!
//! Wall times and the date are in `timing.parquet` and `provenance.json` alone; everything else is the same bytes for
//! the same plan and seed.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use armid::study::{Examples, ReportInput, StudyPlan, StudyResult};

use super::robots::read_robots;
use crate::error::Error;
use crate::output::{pretty, write_text};
use crate::text::Text;

const SUMMARY: &str = "summary.json";
const EXAMPLES: &str = "examples.json";

/// Everything that decides a study's rows, as a text whose hash says whether stored work belongs to it.
///
/// # Errors
/// [`Error`] where the plan has no such text.
pub fn plan_text(plan: &StudyPlan) -> Result<String, Error> {
    toml::to_string_pretty(plan).map_err(|error| Error::new(format!("the plan cannot be written: {error}")))
}

/// Stores the plan, the designs, the summary and the examples.
///
/// # Errors
/// [`Error`] where a file cannot be written.
pub fn write(folder: &Path, input: &ReportInput) -> Result<(), Error> {
    let result = &input.result;
    write_text(&folder.join("study.toml"), &plan_text(&result.plan)?)?;
    for design in &result.designs {
        let family = &result.plan.designs[design.family].name;
        let text = design.trajectory.to_toml();
        write_text(&folder.join("designs").join(format!("{family}-{}.toml", design.start)), &text)?;
    }
    write_text(&folder.join(EXAMPLES), &json(&input.examples)?)?;
    write_text(&folder.join(SUMMARY), &json(result)?)
}

/// Reads a stored study again.
///
/// # Errors
/// As [`parse`], and where a file cannot be read, or the folder is that of a study on several robots.
pub fn read(folder: &Path) -> Result<ReportInput, Error> {
    let stored = || parse(&Text::read(&folder.join(SUMMARY))?, &Text::read(&folder.join(EXAMPLES))?);
    stored().map_err(|error| match read_robots(folder) {
        Ok(Some(summary)) => {
            let folders: Vec<String> =
                summary.robots.iter().map(|robot| folder.join(&robot.folder).display().to_string()).collect();
            let shown = folder.display();
            Error::mismatch(format!("{shown} holds a study on several robots, expected that on one of them"))
                .help(format!("expected one of: {}", folders.join(", ")))
        }
        Ok(None) | Err(_) => error,
    })
}

/// A stored study from the texts of its summary and its examples.
///
/// # Errors
/// [`Error`] where a text is cut or of another version, or the study is not complete.
pub fn parse(summary: &Text, examples: &Text) -> Result<ReportInput, Error> {
    let fault = |text: &Text, error: &serde_json::Error| {
        Error::of_json(text, error).help("expected a study that this version stored")
    };
    let result: StudyResult = serde_json::from_str(&summary.content).map_err(|error| fault(summary, &error))?;
    let examples: Examples = serde_json::from_str(&examples.content).map_err(|error| fault(examples, &error))?;
    let input = ReportInput { result, examples };
    input.check().map_err(|error| {
        Error::new(format!("{}: {error}", summary.name)).help("expected a study that this version stored")
    })?;
    Ok(input)
}

/// Stores what differs from one performance to the next, beside `timing.parquet`: the date, the number of threads.
///
/// # Errors
/// [`Error`] where it cannot be written.
pub fn write_provenance(folder: &Path, threads: usize) -> Result<(), Error> {
    let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let provenance = serde_json::json!({
        "armid": env!("CARGO_PKG_VERSION"),
        "finished_unix_s": unix_s,
        "threads": threads,
        "operating_system": std::env::consts::OS,
        "architecture": std::env::consts::ARCH,
    });
    write_text(&folder.join("provenance.json"), &pretty(&provenance))
}

fn json<T: serde::Serialize>(value: &T) -> Result<String, Error> {
    let mut text = serde_json::to_string(value).map_err(|error| Error::new(format!("a result: {error}")))?;
    text.push('\n');
    Ok(text)
}
