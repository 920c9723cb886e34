//! From a log to samples of a robot.

use armid::estimation::{Estimate, EstimationError, EstimatorKind, Identification, Validation};
use armid::input::size::PERIOD_SAMPLES;
use armid::model::{Columns, Robot};
use armid::signal::{
    AperiodicRecord, PeriodicRecord, Processing, Samples, SignalError, process, process_aperiodic, process_periods,
};

use super::gaps::Gaps;
use super::joint_log::Log;
use crate::error::Error;
use crate::robot::LoadedRobot;

/// What a log does not contain, and how it becomes samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogSettings {
    /// Period of a log that does not say it, s; without one it is taken as not periodic.
    pub period_s: Option<f64>,
    /// Seconds to leave out at the beginning of a log that does not say what counts.
    pub skip_s: f64,
    /// Derivatives, cut-off, samples that are kept.
    pub processing: Processing,
}

impl LogSettings {
    /// For a log of a motion that repeats itself every `period_s` seconds.
    #[must_use]
    pub fn periodic(period_s: f64) -> Self {
        Self { period_s: Some(period_s), ..Self::default() }
    }
}

/// A log that has become samples.
#[derive(Clone, Debug)]
pub struct ProcessedLog {
    /// The log, with the robot's joints in the robot's order.
    pub log: Log,
    /// The robot.
    pub robot: LoadedRobot,
    /// What identification works on.
    pub samples: Samples,
    /// What was missing, where anything was.
    pub gaps: Option<Gaps>,
}

impl Log {
    /// Samples of a robot: joints in its order, periods with missing samples left out, periods averaged.
    ///
    /// # Errors
    /// [`Error`] where the log is of other joints, its period is no whole number of samples, or nothing is left.
    pub fn process(self, robot: LoadedRobot, settings: &LogSettings) -> Result<ProcessedLog, Error> {
        let mut log = arranged(self, &robot.robot)?;
        let gaps = Gaps::leave_out(&mut log)?;
        let samples = samples(&log, &robot.robot, settings)?;
        Ok(ProcessedLog { log, robot, samples, gaps })
    }
}

impl ProcessedLog {
    /// Estimates the base parameters of these columns.
    ///
    /// # Errors
    /// [`Error`] where the motion does not reveal them or the equations have no answer.
    pub fn identify(&self, columns: Columns, estimator: EstimatorKind) -> Result<Estimate, Error> {
        let mut estimates = self.identify_by(columns, &[estimator])?;
        estimates.pop().ok_or_else(|| Error::new("no estimator is named, expected one"))
    }

    /// The same by several estimators.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_by(&self, columns: Columns, estimators: &[EstimatorKind]) -> Result<Vec<Estimate>, Error> {
        let named = |error: EstimationError| self.unestimated(&error);
        let mut identification = Identification::new(&self.robot.robot, columns).map_err(named)?;
        if let Some(guess) = self.robot.guess() {
            identification = identification.with_nominal(guess);
        }
        estimators.iter().map(|kind| identification.estimate(&self.samples, kind.estimator()).map_err(named)).collect()
    }

    /// Compares what an estimate predicts with this log. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn validate(&self, estimate: &Estimate, name: &str) -> Result<Validation, Error> {
        let robot = &self.robot.robot;
        if estimate.robot != robot.name() {
            let message = format!("{name} is of robot \"{}\", expected \"{}\"", estimate.robot, robot.name());
            return Err(Error::mismatch(message));
        }
        let columns = Columns::parse(&estimate.columns).ok_or_else(|| {
            let names = Columns::ALL.map(|columns| columns.to_string()).join(", ");
            Error::new(format!("{name}: columns is \"{}\", expected one of {names}", estimate.columns))
        })?;
        let named = |error: EstimationError| Error::mismatch(format!("{name}: {error}"));
        Identification::new(robot, columns).and_then(|of| of.validate(estimate, &self.samples)).map_err(named)
    }

    fn unestimated(&self, error: &EstimationError) -> Error {
        let shown = Error::new(format!("{}: {error}", self.log.name));
        match error {
            EstimationError::NotExcited { .. } => shown.help(
                "`armid reduce ROBOT --trajectory T.toml` shows what a motion reveals; `armid design` finds one that \
                 reveals all",
            ),
            _ => shown,
        }
    }
}

/// The log with the robot's joints in the robot's order; joints of other things, a gripper's, are left out.
fn arranged(mut log: Log, robot: &Robot) -> Result<Log, Error> {
    let expected: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let Some(joints) = &log.joints else {
        if log.dof == robot.dof() {
            return Ok(log);
        }
        let (found, expected) = (log.dof, robot.dof());
        let message =
            format!("{} holds {found} joints, expected the {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Error::mismatch(message));
    };
    if *joints == expected {
        return Ok(log);
    }
    let order: Option<Vec<usize>> = expected.iter().map(|name| joints.iter().position(|found| found == name)).collect();
    let Some(order) = order.filter(|_| log.recording.is_none()) else {
        let (found, expected) = (joints.join(", "), expected.join(", "));
        let message =
            format!("{} holds the joints {found}, expected {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Error::mismatch(message));
    };
    let pick = |table: &[f64]| -> Vec<f64> {
        table.chunks_exact(joints.len()).flat_map(|row| order.iter().map(|&joint| row[joint])).collect()
    };
    (log.q, log.effort) = (pick(&log.q), pick(&log.effort));
    log.dof = robot.dof();
    log.joints = Some(expected.into_iter().map(str::to_owned).collect());
    Ok(log)
}

fn samples(log: &Log, robot: &Robot, settings: &LogSettings) -> Result<Samples, Error> {
    let processing = &settings.processing;
    PERIOD_SAMPLES.check_count("number of samples that a period is reduced to", processing.samples_per_period)?;
    let fault = |error: SignalError| -> Error { Error::new(format!("{}: {error}", log.name)) };
    if let Some(recording) = &log.recording {
        if let Some(period) = settings.period_s {
            let message = format!("{} says its own period, found a period of {period} s", log.name);
            return Err(Error::new(message));
        }
        return process(recording, robot, processing).map_err(fault);
    }
    if !(settings.skip_s.is_finite() && settings.skip_s >= 0.0) {
        return Err(Error::new(format!("skip is {} s, expected seconds not below zero", settings.skip_s)));
    }
    let n = log.dof;
    let effort_unit = log.effort_unit.unwrap_or_else(|| robot.effort());
    let first = ((settings.skip_s * log.rate_hz).round() as usize).min(log.q.len() / n);
    let (q, effort) = (&log.q[first * n..], &log.effort[first * n..]);
    let Some(period) = settings.period_s else {
        let record = AperiodicRecord { dof: n, rate_hz: log.rate_hz, q, effort };
        let thinned = (4.0 * processing.cutoff_hz(0.0)).min(log.rate_hz);
        return process_aperiodic(&record, robot, effort_unit, thinned, processing).map_err(fault);
    };
    let whole = period * log.rate_hz;
    let period_samples = whole.round();
    PERIOD_SAMPLES.check("number of samples of a period", period_samples)?;
    if !(period_samples >= 8.0 && (whole - period_samples).abs() < 1e-3) {
        let message = format!(
            "a period of {period} s is {whole:.3} samples at the {} Hz of {}, expected a whole number of at least 8",
            log.rate_hz, log.name
        );
        return Err(Error::new(message));
    }
    let period_samples = period_samples as usize;
    let periods = q.len() / (n * period_samples);
    if periods == 0 {
        let message = format!(
            "{} holds {:.3} s after those that are skipped, expected at least one period of {period} s",
            log.name,
            (q.len() / n) as f64 / log.rate_hz
        );
        return Err(Error::new(message));
    }
    let rows = 0..periods * period_samples * n;
    let record =
        PeriodicRecord { dof: n, rate_hz: log.rate_hz, period_samples, q: &q[rows.clone()], effort: &effort[rows] };
    process_periods(&record, robot, effort_unit, 0.0, processing).map_err(fault)
}
