//! What a stored study says about the size of the next one: its rows, read again.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting, Task};
use armid::study::{Metric, StoppingRule, StudyResult};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};

use crate::error::Error;

/// Logarithms of the ratios of a rule's two families in a stored study, by pair of starts and by run: those that both starts
/// of a pair gave, with its last estimator under its first condition. Runs on the same drawn truth stand as one, and a run that
/// one pair lacks is left out of all.
///
/// # Errors
/// [`Error`] where the pilot lacks a family, or the rows cannot be read.
pub fn log_ratios(folder: &Path, pilot: &StudyResult, rule: &StoppingRule) -> Result<Vec<Vec<f64>>, Error> {
    let plan = &pilot.plan;
    let place = |name: &String| {
        plan.designs.iter().position(|family| family.name == *name).ok_or_else(|| {
            let names: Vec<&str> = plan.designs.iter().map(|family| family.name.as_str()).collect();
            let until = Remedy::default().setting(Setting::Until);
            Error::new(format!("{until} is \"{name}\", expected one of the families: {}", names.join(", ")))
        })
    };
    let families = [place(&rule.first)?, place(&rule.second)?];
    let (estimator, condition) = (plan.identification.estimators.last(), &pilot.conditions[0].condition.name);
    let truths = plan.truths.as_ref().map_or(usize::MAX, |truths| truths.count);
    // Values of each run, or of each truth, of each start of the two families.
    let mut values: BTreeMap<(usize, usize), [Vec<f64>; 2]> = BTreeMap::new();
    let names = ["design", "run", "condition", "estimator", column(rule.metric)];
    rows(&folder.join("runs.parquet"), &names, |row| {
        if text(&row[2]) != Some(condition) || text(&row[3]) != estimator.map(String::as_str) {
            return;
        }
        let (Field::Long(design), Field::Long(run), Field::Double(value)) = (&row[0], &row[1], &row[4]) else { return };
        let (design, run) = (usize::try_from(*design).unwrap_or(usize::MAX), usize::try_from(*run).unwrap_or(0));
        let Some(made) = pilot.designs.get(design) else { return };
        if let Some(side) = families.iter().position(|&family| family == made.family) {
            values.entry((made.start, run % truths)).or_default()[side].push(*value);
        }
    })?;
    let mut logs: BTreeMap<usize, BTreeMap<usize, f64>> = BTreeMap::new();
    for ((start, run), [first, second]) in &values {
        if let Some(log) = StoppingRule::log_ratio(first, second) {
            logs.entry(*start).or_default().insert(*run, log);
        }
    }
    let everywhere = |run: &usize| logs.values().all(|of_start| of_start.contains_key(run));
    let balanced = |of_start: &BTreeMap<usize, f64>| {
        of_start.iter().filter(|(run, _)| everywhere(run)).map(|(_, log)| *log).collect()
    };
    Ok(logs.values().map(balanced).collect())
}

/// One metric of a run with an estimator.
#[derive(Clone, Debug, PartialEq)]
pub struct RunValue {
    /// Name of the designs that its own is one of.
    pub family: String,
    /// Name of the condition.
    pub condition: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Number of the run; runs of one number have one noise and, in studies of drawn arms, one arm.
    pub run: usize,
    /// The metric; `None` where the run gave none.
    pub value: Option<f64>,
}

/// A metric of every run of a stored study, in the order of its rows.
///
/// # Errors
/// [`Error`] where the rows cannot be read.
pub fn run_values(folder: &Path, metric: Metric) -> Result<Vec<RunValue>, Error> {
    let mut all = Vec::new();
    rows(&folder.join("runs.parquet"), &["family", "condition", "estimator", "run", column(metric)], |row| {
        let [family, condition, estimator] = [0, 1, 2].map(|k| text(&row[k]).unwrap_or_default().to_owned());
        let run = if let Field::Long(run) = row[3] { usize::try_from(run).unwrap_or_default() } else { 0 };
        let value = if let Field::Double(value) = row[4] { Some(value) } else { None };
        all.push(RunValue { family, condition, estimator, run, value });
    })?;
    Ok(all)
}

/// The errors of the base parameters by a run with an estimator, in the parameters' units.
#[derive(Clone, Debug, PartialEq)]
pub struct RunErrors {
    /// Name of the designs that its own is one of.
    pub family: String,
    /// Name of the condition.
    pub condition: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Number of the run.
    pub run: usize,
    /// Estimate less truth, b.
    pub errors: Vec<f64>,
}

/// The errors of every run of a stored study that gave an estimate, in the order of its rows. `families` has the name of each design's.
///
/// # Errors
/// [`Error`] where the rows cannot be read.
pub fn run_errors(folder: &Path, families: &[&str]) -> Result<Vec<RunErrors>, Error> {
    let mut all: Vec<RunErrors> = Vec::new();
    rows(
        &folder.join("parameters.parquet"),
        &["design", "condition", "estimator", "run", "estimate", "true"],
        |row| {
            let (Field::Long(design), Field::Long(run)) = (&row[0], &row[3]) else { return };
            let (Field::Double(estimate), Field::Double(truth)) = (&row[4], &row[5]) else { return };
            let place = |number: &i64| usize::try_from(*number).unwrap_or(usize::MAX);
            let Some(family) = families.get(place(design)) else { return };
            let [condition, estimator] = [1, 2].map(|k| text(&row[k]).unwrap_or_default().to_owned());
            let found =
                RunErrors { family: (*family).to_owned(), condition, estimator, run: place(run), errors: Vec::new() };
            let is_same = |of: &&mut RunErrors| {
                let key = |of: &RunErrors| (of.run, of.family.clone(), of.condition.clone(), of.estimator.clone());
                key(of) == key(&found)
            };
            match all.last_mut().filter(is_same) {
                Some(last) => last.errors.push(estimate - truth),
                None => all.push(RunErrors { errors: vec![estimate - truth], ..found }),
            }
        },
    )?;
    Ok(all)
}

/// Mean wall time of a design and of a run of a stored study, s.
///
/// # Errors
/// [`Error`] where the rows cannot be read.
pub fn design_and_run_seconds(folder: &Path) -> Result<(f64, f64), Error> {
    let (mut designs, mut runs) = ((0.0, 0.0), (0.0, 0.0));
    rows(&folder.join("timing.parquet"), &["kind", "seconds"], |row| {
        let Field::Double(seconds) = row[1] else { return };
        let sum = if text(&row[0]) == Some("design") { &mut designs } else { &mut runs };
        sum.0 += seconds;
        sum.1 += 1.0;
    })?;
    let mean = |(sum, count): (f64, f64)| if count > 0.0 { sum / count } else { 0.0 };
    Ok((mean(designs), mean(runs)))
}

/// The column of a metric.
const fn column(metric: Metric) -> &'static str {
    match metric {
        Metric::Prediction | Metric::LogVolume => "prediction_rmse_nm",
        Metric::PredictionOfRating => "prediction_rmse_of_rating",
        Metric::Reference => "reference_rmse",
        Metric::Si => "si_rmse",
        Metric::Measured => "measured_rmse_nm",
        Metric::Slow => "slow_rmse_nm",
        Metric::PointToPoint => "point_to_point_rmse_nm",
        Metric::Static => "static_rmse_nm",
    }
}

fn text(field: &Field) -> Option<&str> {
    match field {
        Field::Str(text) => Some(text),
        _ => None,
    }
}

/// Hands over these columns of every row of a file.
fn rows(path: &PathBuf, names: &[&str], mut take: impl FnMut(&[Field])) -> Result<(), Error> {
    let fault = |error: parquet::errors::ParquetError| Error::unreadable(path, &std::io::Error::other(error));
    let file = File::open(path).map_err(|error| Error::unreadable(path, &error))?;
    let reader = SerializedFileReader::new(file).map_err(fault)?;
    for row in reader.get_row_iter(None).map_err(fault)? {
        let row: Row = row.map_err(fault)?;
        let all: BTreeMap<&String, &Field> = row.get_column_iter().collect();
        let cells: Option<Vec<Field>> =
            names.iter().map(|name| all.get(&(*name).to_owned()).copied().cloned()).collect();
        let cells = cells.ok_or_else(|| {
            Error::new(format!("{}: expected the columns {}", path.display(), names.join(", ")))
                .help(Remedy::task(Task::Study, "STUDY").option(Setting::Output, "DIR").say(" writes them"))
        })?;
        take(&cells);
    }
    Ok(())
}
