//! What is done with estimates, which come with a name for messages and as the text of their files.

use std::path::{Path, PathBuf};

use armid::codegen::Language;
use armid::estimation::{Estimate, EstimatorKind, TorqueSeries, predict as predicted};
use armid::model::Columns;
use armid::model::format::ChainEnds;
use armid::observer::Observer;
use armid::statistics::student_quantile;
use armid::trajectory::States;
use armid_io::log::{HeldOut, find};
use armid_io::robot::ChainSource;
use armid_io::{Error, Inputs, LogSettings, ProcessedLog, Text, estimate};
use armid_workflow::export::{Exchange, ExportSettings, export as exported, export_source};
use armid_workflow::report::{EstimatePage, Sheet, TorqueComparison};
use armid_workflow::{PayloadSide, columns_of, payload as payload_of, validate as validated};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadwriteArrayDyn};
use pyo3::prelude::*;

use crate::arrays::{Rows, output, samples_of};
use crate::fault::{exception, unexpected};
use crate::identification::{processed, samples};
use crate::log::Log;
use crate::robot::Robot;
use crate::watch::{Leaves, watched};

/// The file of an estimate: what it is called, and its text.
type File<'a> = (&'a str, &'a str);

/// An estimate, and what it was made from.
struct Made {
    estimate: Estimate,
    name: String,
    inputs: Option<Inputs>,
}

impl Made {
    fn parse((name, text): File<'_>) -> Result<Self, Error> {
        let text = Text::new(name, text);
        Ok(Self { estimate: estimate::parse(&text)?, inputs: Inputs::of_estimate(&text)?, name: text.name })
    }

    /// The logs that it was made from, processed again as it was made. Where none are given, they are read again.
    fn log(&self, robot: &Robot, [logs, held_out]: &[Vec<Log>; 2]) -> Result<(ProcessedLog, &Inputs), Error> {
        let name = &self.name;
        let inputs = self.inputs.as_ref();
        let inputs = inputs.ok_or_else(|| Error::new(format!("{name} does not state what it was made from")))?;
        inputs.check_robot(&robot.loaded, name)?;
        let settings = inputs.settings.clone();
        let read = |paths: &[PathBuf]| -> Result<ProcessedLog, Error> {
            let of = Some(&robot.loaded.robot);
            samples(robot, find(paths, inputs.mapping.as_deref(), inputs.rate_hz, of, false)?.logs, &settings)
        };
        if !logs.is_empty() {
            let (mut log, _) = processed(robot, logs, &settings)?;
            if !held_out.is_empty() {
                log.hold_out(&processed(robot, held_out, &settings)?.0);
            }
            return Ok((log, inputs));
        }
        if inputs.logs.is_empty() {
            return Err(Error::new(format!("{name} was made from arrays, which are gone, expected logs=")));
        }
        let paths: Vec<PathBuf> = inputs.logs.iter().map(PathBuf::from).collect();
        let mut log = read(&paths)?;
        let files: Vec<_> = log.logs.iter().flat_map(|log| log.origin.files.clone()).collect();
        inputs.check_files(&files, name)?;
        if let Some(other) = &inputs.held_out_log {
            log.hold_out(&read(&[PathBuf::from(other)])?);
        }
        Ok((log, inputs))
    }
}

/// How other logs are processed: as those of an estimate were, with its period where they state none.
fn as_before(before: LogSettings, logs: &[Log], part_s: (Option<f64>, Option<f64>)) -> LogSettings {
    let is_foreign = logs.iter().any(|log| log.log.recording.is_none());
    let stated = logs.iter().find_map(|log| log.period_s);
    let is_remembered = stated.is_none() && is_foreign && before.period_s.is_some();
    let from_s = part_s.0.or_else(|| logs.iter().find_map(|log| log.part_s.0));
    LogSettings {
        period_s: if is_remembered { before.period_s } else { stated },
        from_s: from_s.unwrap_or(if is_remembered { before.from_s } else { 0.0 }),
        until_s: part_s.1.or_else(|| logs.iter().find_map(|log| log.part_s.1)),
        held_out: HeldOut::Nothing,
        measured_velocity: is_foreign && before.measured_velocity,
        ..before
    }
}

/// Logs that a thread may keep.
fn kept(logs: [Vec<PyRef<'_, Log>>; 2]) -> [Vec<Log>; 2] {
    logs.map(|logs| logs.iter().map(|log| Log::clone(log)).collect())
}

/// Torque that an estimate predicts for every sample, N × n, into `out`.
#[pyfunction]
pub(crate) fn predict(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    samples: [Rows<'_>; 3],
    mut out: PyReadwriteArrayDyn<'_, f64>,
) -> PyResult<()> {
    let [q, qd, qdd] = &samples;
    let Made { estimate, name, .. } = Made::parse(file).map_err(exception)?;
    estimate::check_robot(&estimate, &name, &robot.loaded).map_err(exception)?;
    let columns = columns_of(&estimate, &name).map_err(exception)?;
    let [q, qd, qdd] = samples_of(robot.dof(), [q, qd, qdd])?.map(<[f64]>::to_vec);
    let states = States { dof: robot.dof(), q, qd, qdd };
    let out = output(&mut out, &[states.len(), robot.dof()])?;
    let torque = py.detach(|| {
        let regressor = estimate.regressor(&robot.loaded.robot, columns)?;
        predicted(&estimate, &regressor, &states)
    });
    out.copy_from_slice(&torque.map_err(unexpected)?);
    Ok(())
}

/// How well an estimate predicts other logs, as the command's answer. Processing is that of the estimate, with its period where the logs
/// state none.
#[pyfunction]
pub(crate) fn validate(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    logs: Vec<PyRef<'_, Log>>,
    limit: f64,
    part_s: (Option<f64>, Option<f64>),
) -> PyResult<String> {
    let made = Made::parse(file).map_err(exception)?;
    let (robot, [logs, _]) = (robot.clone(), kept([logs, Vec::new()]));
    let answer = watched(py, None, Leaves::Nothing, move |observer| {
        let before = made.inputs.as_ref().map(|inputs| inputs.settings.clone()).unwrap_or_default();
        let settings = as_before(before, &logs, part_s);
        let (log, now) = processed(&robot, &logs, &settings)?;
        let estimates = std::slice::from_ref(&made.estimate);
        let answer = validated(estimates, &made.name, &log, [made.inputs.as_ref(), Some(&now)], limit, observer)?;
        serde_json::to_string(&answer).map_err(Error::new)
    })?;
    answer.map_err(exception)
}

/// A file of another tool that was written: its text, the command's answer, and what is wrong with it where it is not sound.
type Written = (String, String, Option<String>);

/// An estimate as a model or as source code. `into` is a file that gets the numbers, `path` where the text will stand.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "one for each keyword of the call")]
pub(crate) fn export(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    logs: [Vec<PyRef<'_, Log>>; 2],
    to: &str,
    into: Option<PathBuf>,
    path: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Written> {
    const FORMATS: [Exchange; 6] =
        [Exchange::Urdf, Exchange::Mjcf, Exchange::Toml, Exchange::Json, Exchange::Isaac, Exchange::Python];
    let made = Made::parse(file).map_err(exception)?;
    estimate::check_robot(&made.estimate, &made.name, &robot.loaded).map_err(exception)?;
    if let Some(language) = [Language::C, Language::Rust].into_iter().find(|language| language.name() == to) {
        let source = py.detach(|| export_source(&made.estimate, &made.name, &robot.loaded, language, path));
        let source = source.map_err(exception)?;
        let fault =
            (!source.is_sound()).then(|| "the operations of the source code differ from the regressor".to_owned());
        let answer = serde_json::to_string(&source).map_err(unexpected)?;
        return Ok((source.text, answer, fault));
    }
    let Some(format) = FORMATS.into_iter().find(|format| format.name() == to) else {
        return Err(unexpected(format!(
            "to is \"{to}\", expected one of urdf, mjcf, toml, json, isaac, python, c, rust"
        )));
    };
    if into.is_some() && !matches!(format, Exchange::Urdf | Exchange::Mjcf) {
        return Err(unexpected(format!("into is for urdf and mjcf, found {to}")));
    }
    let (robot, logs) = (robot.clone(), kept(logs));
    let answer = watched(py, progress, Leaves::Nothing, move |observer| {
        let template = |path: &Path| -> Result<ChainSource, Error> {
            // Names of links need not be the same in another format.
            let ends = format.template(&robot.loaded).map_or_else(ChainEnds::default, |own| own.ends.clone());
            Ok(ChainSource { text: Text::read(path)?, ends })
        };
        let settings = ExportSettings { format, into: into.as_deref().map(template).transpose()?, file: path };
        let (log, _) = made.log(&robot, &logs)?;
        let file = exported(&made.estimate, &made.name, log, &settings, observer)?;
        let fault = (!file.is_sound()).then(|| file.prediction.sentence(&file.name));
        Ok((file.text.clone(), serde_json::to_string(&file).map_err(Error::new)?, fault))
    })?;
    answer.map_err(exception)
}

/// Whether the rows are held out, their rate, Hz, and two tables of torque, N × n.
type Torque<'py> = (bool, f64, [Bound<'py, PyArray2<f64>>; 2]);

/// Measured and predicted torque below the bandwidth of the estimate.
#[pyfunction]
pub(crate) fn torque<'py>(
    py: Python<'py>,
    robot: &Robot,
    file: File<'_>,
    logs: [Vec<PyRef<'_, Log>>; 2],
) -> PyResult<Torque<'py>> {
    let n = robot.dof();
    let (is_held_out, rate_hz, [measured, predicted]) = compared(py, robot, file, logs, |torque| {
        let TorqueSeries { measured, predicted } = torque.series;
        Ok((torque.is_held_out, torque.samples.rate_hz, [measured, predicted]))
    })?;
    let table = |values: Vec<f64>| {
        let rows = values.len() / n;
        PyArray1::from_vec(py, values).reshape([rows, n])
    };
    Ok((is_held_out, rate_hz, [table(measured)?, table(predicted)?]))
}

/// The figure of the page as one SVG element.
#[pyfunction]
pub(crate) fn draw(py: Python<'_>, robot: &Robot, file: File<'_>, logs: [Vec<PyRef<'_, Log>>; 2]) -> PyResult<String> {
    compared(py, robot, file, logs, |torque| torque.svg())
}

/// A motion of the arm with measured and predicted torque as MCAP, into a file.
#[pyfunction]
pub(crate) fn write_mcap(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    logs: [Vec<PyRef<'_, Log>>; 2],
    path: PathBuf,
) -> PyResult<()> {
    let loaded = robot.loaded.clone();
    compared(py, robot, file, logs, move |torque| torque.write_mcap(&path, &loaded.robot))
}

/// What a function makes of measured and predicted torque.
fn compared<T: Send + 'static>(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    logs: [Vec<PyRef<'_, Log>>; 2],
    of: impl FnOnce(TorqueComparison<'_>) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let made = Made::parse(file).map_err(exception)?;
    let (robot, logs) = (robot.clone(), kept(logs));
    let answer = watched(py, None, Leaves::Nothing, move |_| {
        let (log, _) = made.log(&robot, &logs)?;
        of(TorqueComparison::new(&made.estimate, &made.name, &log)?)
    })?;
    answer.map_err(exception)
}

/// Draws the page of an estimate into a folder; returns the page. Logs are read where the file holds no figures of them.
#[pyfunction]
pub(crate) fn report(
    py: Python<'_>,
    robot: &Robot,
    file: File<'_>,
    logs: [Vec<PyRef<'_, Log>>; 2],
    folder: PathBuf,
) -> PyResult<PathBuf> {
    let made = Made::parse(file).map_err(exception)?;
    let stored = EstimatePage::of_file(&Text::new(file.0, file.1)).map_err(exception)?;
    let (robot, logs) = (robot.clone(), kept(logs));
    let page = watched(py, None, Leaves::Files, move |observer| {
        let page = match stored {
            Some(page) => page,
            None => {
                let (log, inputs) = made.log(&robot, &logs)?;
                EstimatePage::of_log(&made.estimate, &made.name, &log, inputs.clone(), observer)?
            }
        };
        page.write(&folder, &made.estimate, Sheet::Screen)
    })?;
    page.map_err(exception)
}

/// The arm without its load or with it: the file of an estimate, or logs.
#[derive(FromPyObject)]
pub(crate) enum Side<'py> {
    Estimate(String, String),
    Logs(Vec<PyRef<'py, Log>>),
}

/// A [`Side`] that a thread may keep.
enum Kept {
    Estimate(Box<PayloadSide>),
    Logs(Vec<Log>),
}

impl Kept {
    fn of(side: Side<'_>) -> Result<Self, Error> {
        Ok(match side {
            Side::Estimate(name, text) => {
                let Made { estimate, name, inputs } = Made::parse((&name, &text))?;
                Self::Estimate(Box::new(PayloadSide { estimate, name, inputs }))
            }
            Side::Logs(logs) => Self::Logs(logs.iter().map(|log| Log::clone(log)).collect()),
        })
    }

    /// The estimate; of logs processed as those of the other side were, with its columns and its speeds of friction.
    fn made(self, robot: &Robot, other: Option<&PayloadSide>, observer: &dyn Observer) -> Result<PayloadSide, Error> {
        let logs = match self {
            Self::Estimate(side) => return Ok(*side),
            Self::Logs(logs) => logs,
        };
        let usual = LogSettings { finds_period: true, ..LogSettings::default() };
        let before = other.and_then(|other| other.inputs.as_ref()).map_or(usual, |inputs| inputs.settings.clone());
        let columns = match other {
            Some(other) => columns_of(&other.estimate, &other.name)?,
            None => Columns::RIGID_ROTOR_FRICTION,
        };
        let (mut log, inputs) = processed(robot, &logs, &as_before(before, &logs, (None, None)))?;
        PayloadSide::of_log(&mut log, Some(inputs), columns, EstimatorKind::Wls, other, observer)
    }
}

/// The load by which an arm with it differs from the same arm without, as the command's answer.
#[pyfunction]
pub(crate) fn payload(
    py: Python<'_>,
    robot: &Robot,
    without: Side<'_>,
    with: Side<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (without, with) = (Kept::of(without).map_err(exception)?, Kept::of(with).map_err(exception)?);
    let robot = robot.clone();
    let answer = watched(py, progress, Leaves::Nothing, move |observer| {
        let (without, with) = match with {
            // An estimate is what the logs of the other side go by.
            Kept::Estimate(with) => (without.made(&robot, Some(&with), observer)?, *with),
            logs @ Kept::Logs(_) => {
                let without = without.made(&robot, None, observer)?;
                let with = logs.made(&robot, Some(&without), observer)?;
                (without, with)
            }
        };
        serde_json::to_string(&payload_of(&robot.loaded, without, with)?).map_err(Error::new)
    })?;
    answer.map_err(exception)
}

/// Half the width of an interval that holds a share `level` of Student's t, in standard deviations.
#[pyfunction]
pub(crate) fn student(level: f64, degrees_of_freedom: f64) -> PyResult<f64> {
    if !(0.0 < level && level < 1.0 && degrees_of_freedom > 0.0) {
        return Err(unexpected(format!("the level is {level}, expected a number between 0 and 1")));
    }
    Ok(student_quantile(0.5 * (1.0 + level), degrees_of_freedom))
}
