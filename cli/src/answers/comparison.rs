//! `armid report --compare`: two estimates from their files.

use std::path::{Path, PathBuf};

use armid::estimation::{Estimate, compare};
use armid_io::output::{pretty, write_text};
use armid_io::{Error, Text, estimate};
use armid_reports::{ComparisonInput, Prediction, comparison_document};
use miette::Result;
use serde::Deserialize;
use serde_json::json;

use crate::arguments::ChainArguments;
use crate::terminal::Answer;

/// What `armid validate` says, as far as it is shown.
#[derive(Deserialize)]
struct Validated {
    rms: Vec<f64>,
    relative_rms: Vec<f64>,
}

struct Side {
    label: String,
    estimate: Estimate,
    prediction: Option<Prediction>,
}

/// Reads an estimate: a JSON of `armid identify`, or a folder with `estimate.json` and, where there is one,
/// `validation.json`.
fn read(path: &Path) -> Result<Side> {
    let file = if path.is_dir() { path.join("estimate.json") } else { path.to_path_buf() };
    let estimate = estimate::read(&file)?;
    let beside = file.with_file_name("validation.json");
    let prediction = if beside.is_file() {
        let text = Text::read(&beside)?;
        let found: Validated = serde_json::from_str(&text.content)
            .map_err(|error| Error::of_json(&text, &error).help("expected the answer of `armid validate --json`"))?;
        let n = estimate.residual_rms.len();
        if found.rms.len() != n || found.relative_rms.len() != n {
            return Err(Error::new(format!("{}: expected {n} joints", text.name)).into());
        }
        Some(Prediction { rms: found.rms, relative_rms: found.relative_rms })
    } else {
        None
    };
    let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
    let label = stem.map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    Ok(Side { label, estimate, prediction })
}

/// What an estimate was made from.
fn origin(estimate: &Estimate) -> String {
    let (robot, samples, periods) = (&estimate.robot, estimate.samples, estimate.periods);
    let file = estimate.provenance.as_ref().map_or_else(String::new, |provenance| {
        let start: String = provenance.robot_sha256.chars().take(12).collect();
        format!(" as of file {start}…")
    });
    format!("{robot}{file}, {samples} samples that are means over {periods} periods")
}

/// Names of the joints where a robot of that name is bundled, else their numbers: an estimate holds none.
fn joint_names(estimate: &Estimate) -> Vec<String> {
    let count = estimate.residual_rms.len();
    let known = ChainArguments::default().load(&estimate.robot).ok().map(|loaded| loaded.robot);
    match known.filter(|robot| robot.dof() == count) {
        Some(robot) => robot.joints().iter().map(|joint| joint.name.clone()).collect(),
        None => (1..=count).map(|number| format!("joint {number}")).collect(),
    }
}

/// Compares two estimates, and draws the page into `folder`.
pub(crate) fn report(first: &Path, second: &Path, folder: &Path) -> Result<Answer> {
    let (first, second) = (read(first)?, read(second)?);
    let comparison =
        compare(&first.estimate, &second.estimate).map_err(|error| Error::new(format!("the estimates: {error}")))?;
    let joints = joint_names(&first.estimate);
    let input = ComparisonInput {
        comparison,
        origins: [origin(&first.estimate), origin(&second.estimate)],
        labels: [first.label, second.label],
        joints,
        predictions: [first.prediction, second.prediction],
    };
    let fault = |error: armid_reports::DocumentError| Error::new(format!("the report cannot be drawn: {error}"));
    let document = comparison_document(&input).map_err(fault)?;
    for (name, svg) in document.svg_files().map_err(fault)? {
        write_text(&folder.join(name), svg)?;
    }
    let page: PathBuf = folder.join("report.html");
    write_text(&page, &document.html().map_err(fault)?)?;
    let shown = &input.comparison;
    let json = json!({
        "page": page,
        "robot": shown.robot,
        "labels": input.labels,
        "parameters": shown.parameters,
        "beyond": shown.beyond,
        "rms_difference_std": shown.rms_difference_std,
        "residual_rms": shown.residual_rms,
        "units": shown.units,
    });
    write_text(&folder.join("comparison.json"), &pretty(&json))?;
    let text = format!(
        "{}: {} and {}: {} parameters, {:.0} % differ by more than 1.96 standard deviations (noise alone: 5 %), RMS {:.2}\n  {}\n",
        shown.robot,
        input.labels[0],
        input.labels[1],
        shown.parameters.len(),
        100.0 * shown.beyond,
        shown.rms_difference_std,
        page.display()
    );
    Ok(Answer { text, json })
}
