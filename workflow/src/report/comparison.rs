//! Two estimates from their files, side by side.

use std::path::{Path, PathBuf};

use armid::estimation::{Comparison, Estimate, compare};
use armid_io::output::{pretty, write_text};
use armid_io::{Error, Text, estimate, robot};
use armid_reports::{ComparisonInput, Prediction, Sheet, comparison_document};
use serde::{Deserialize, Serialize};

use super::page::write_document;

/// Two estimates, and how they differ. It serialises to the file beside the page.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonAnswer {
    /// The page.
    pub page: PathBuf,
    /// What the estimates are called.
    pub labels: [String; 2],
    /// How they differ.
    #[serde(flatten)]
    pub comparison: Comparison,
}

/// What a validation says, as far as it is shown.
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

/// Reads an estimate: its file, or a folder with `estimate.json` and, where there is one,
/// `validation.json`.
fn read(path: &Path) -> Result<Side, Error> {
    let file = if path.is_dir() { path.join("estimate.json") } else { path.to_path_buf() };
    let estimate = estimate::read(&file)?;
    let beside = file.with_file_name("validation.json");
    let prediction = if beside.is_file() {
        let text = Text::read(&beside)?;
        let found: Validated = serde_json::from_str(&text.content)
            .map_err(|error| Error::of_json(&text, &error).help("expected the answer of a validation"))?;
        let n = estimate.residual_rms.len();
        if found.rms.len() != n || found.relative_rms.len() != n {
            return Err(Error::new(format!("{}: expected {n} joints", text.name)));
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
    let known = robot::find(&estimate.robot).ok().map(|loaded| loaded.robot);
    match known.filter(|robot| robot.dof() == count) {
        Some(robot) => robot.joints().iter().map(|joint| joint.name.clone()).collect(),
        None => (1..=count).map(|number| format!("joint {number}")).collect(),
    }
}

/// Compares two estimates, and draws the page into `folder`, its numbers beside it. `validation.json` beside an estimate is shown with it.
///
/// # Errors
/// [`Error`] where a file cannot be read or written, or the estimates are of unlike robots or parameters.
pub fn write_comparison(folder: &Path, first: &Path, second: &Path, sheet: Sheet) -> Result<ComparisonAnswer, Error> {
    let (first, second) = (read(first)?, read(second)?);
    let comparison =
        compare(&first.estimate, &second.estimate).map_err(|error| Error::new(format!("the estimates: {error}")))?;
    let input = ComparisonInput {
        comparison,
        origins: [origin(&first.estimate), origin(&second.estimate)],
        joints: joint_names(&first.estimate),
        labels: [first.label, second.label],
        predictions: [first.prediction, second.prediction],
    };
    let page = write_document(folder, comparison_document(&input), sheet)?;
    let answer = ComparisonAnswer { page, labels: input.labels, comparison: input.comparison };
    write_text(&folder.join("comparison.json"), &pretty(&serde_json::to_value(&answer).map_err(Error::new)?))?;
    Ok(answer)
}
