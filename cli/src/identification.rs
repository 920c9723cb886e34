//! From a log to samples of a robot: what `identify` and `validate` share.

use std::path::Path;

use armid::signal::{
    AperiodicRecord, Derivatives, PeriodicRecord, Processing, Samples, SignalError, process, process_aperiodic,
    process_periods,
};
use armid_hardware::link::StampFindings;
use miette::Result;
use serde_json::{Value, json};

use crate::choices::one_of;
use crate::fault::Fault;
use crate::files::log::{self, Log};
use crate::robot_source::{self, ChainArguments, LoadedRobot};

/// Which log, of which robot, and how it becomes samples.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LogArguments {
    /// The robot, where the recording does not hold it or another is meant
    #[arg(long)]
    pub(crate) robot: Option<String>,
    #[command(flatten)]
    pub(crate) chain: ChainArguments,
    /// Period of a log that does not say it, s; without one it is taken as not periodic
    #[arg(long, value_name = "S", help_heading = "Processing")]
    pub(crate) period: Option<f64>,
    /// Seconds to leave out at the beginning of a log that does not say what counts
    #[arg(long, value_name = "S", default_value_t = 0.0, help_heading = "Processing")]
    pub(crate) skip: f64,
    /// Velocities and accelerations: through Fourier coefficients, or filtered differences
    #[arg(long, default_value = "fourier", value_parser = one_of(&Derivatives::ALL, Derivatives::name), help_heading = "Processing")]
    pub(crate) derivatives: Derivatives,
    /// Cut-off of the low pass ahead of differences; 5 times the highest commanded frequency, at least 10
    #[arg(long, value_name = "HZ", help_heading = "Processing")]
    pub(crate) cutoff_hz: Option<f64>,
    /// Samples of the averaged period that are kept
    #[arg(long, value_name = "N", default_value_t = 250, help_heading = "Processing")]
    pub(crate) samples: usize,
}

/// A log that has become samples.
pub(crate) struct Prepared {
    pub(crate) log: Log,
    pub(crate) robot: LoadedRobot,
    pub(crate) samples: Samples,
    pub(crate) gaps: Option<Gaps>,
}

/// What is missing in a recording of a real arm, and what that means for its average.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gaps {
    /// Samples that lie on a line across a gap.
    missing: usize,
    /// The recorded periods that hold one, from one.
    periods: Vec<usize>,
    /// Whether those periods are left out; not where they are all there are.
    left_out: bool,
}

impl Gaps {
    /// Leaves out the periods of a recording that hold a missing sample, where others are left.
    fn leave_out(log: &mut Log) -> Result<Option<Self>> {
        let (Some(text), Some(recording)) = (log.notes.get("stamps"), &mut log.recording) else { return Ok(None) };
        let stamps: StampFindings = serde_json::from_str(text)
            .map_err(|error| Fault::new(format!("{}: metadata \"stamps\": {error}", log.name)))?;
        if stamps.missing.is_empty() {
            return Ok(None);
        }
        let mut less = recording.clone();
        let periods: Vec<usize> = less.leave_out(&stamps.missing).into_iter().map(|period| period + 1).collect();
        let left_out = less.periods() > 0 && !periods.is_empty();
        if left_out {
            *recording = less;
        }
        Ok(Some(Self { missing: stamps.missing.len(), periods, left_out }))
    }

    pub(crate) fn text(&self) -> String {
        let list: Vec<String> = self.periods.iter().map(usize::to_string).collect();
        let (missing, list) = (self.missing, list.join(", "));
        match (self.periods.is_empty(), self.left_out) {
            (true, _) => format!("{missing} samples are missing, none of them in a period that counts\n"),
            (_, true) => format!("{missing} samples are missing; left out: period {list}\n"),
            _ => format!("{missing} samples are missing in every period; they lie on lines across the gaps\n"),
        }
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "missing_samples": self.missing, "periods": self.periods, "left_out": self.left_out })
    }
}

/// Reads a log and processes it.
pub(crate) fn prepare(path: &Path, arguments: &LogArguments) -> Result<Prepared> {
    let log = log::read(path)?;
    let robot = robot(&log, arguments)?;
    let mut log = arranged(log, &robot)?;
    let gaps = Gaps::leave_out(&mut log)?;
    let samples = samples(&log, &robot, arguments)?;
    Ok(Prepared { log, robot, samples, gaps })
}

fn robot(log: &Log, arguments: &LogArguments) -> Result<LoadedRobot> {
    match (&arguments.robot, &log.robot) {
        (Some(name), _) => robot_source::load(name, &arguments.chain, None),
        (None, Some(recorded)) => robot_source::of_recording(&log.name, recorded),
        (None, None) => {
            let message = format!("{} does not say which robot it is of, expected --robot ROBOT", log.name);
            Err(Fault::new(message).into())
        }
    }
}

/// The log with the robot's joints in the robot's order; joints of other things, a gripper's, are left out.
fn arranged(mut log: Log, loaded: &LoadedRobot) -> Result<Log> {
    let robot = &loaded.robot;
    let expected: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let Some(joints) = &log.joints else {
        if log.dof == robot.dof() {
            return Ok(log);
        }
        let (found, expected) = (log.dof, robot.dof());
        let message =
            format!("{} holds {found} joints, expected the {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Fault::new(message).into());
    };
    if *joints == expected {
        return Ok(log);
    }
    let order: Option<Vec<usize>> = expected.iter().map(|name| joints.iter().position(|found| found == name)).collect();
    let Some(order) = order.filter(|_| log.recording.is_none()) else {
        let (found, expected) = (joints.join(", "), expected.join(", "));
        let message =
            format!("{} holds the joints {found}, expected {expected} of robot \"{}\"", log.name, robot.name());
        return Err(Fault::new(message).into());
    };
    let pick = |table: &[f64]| -> Vec<f64> {
        table.chunks_exact(joints.len()).flat_map(|row| order.iter().map(|&joint| row[joint])).collect()
    };
    (log.q, log.effort) = (pick(&log.q), pick(&log.effort));
    log.dof = robot.dof();
    log.joints = Some(expected.into_iter().map(str::to_owned).collect());
    Ok(log)
}

fn samples(log: &Log, loaded: &LoadedRobot, arguments: &LogArguments) -> Result<Samples> {
    let robot = &loaded.robot;
    let mut processing =
        Processing { derivatives: arguments.derivatives, cutoff_hz: arguments.cutoff_hz, ..Processing::default() };
    processing.samples_per_period = arguments.samples;
    let fault = |error: SignalError| -> miette::Report { Fault::new(format!("{}: {error}", log.name)).into() };
    if let Some(recording) = &log.recording {
        if let Some(period) = arguments.period {
            let message = format!("{} says its own period, found --period {period}", log.name);
            return Err(Fault::new(message).into());
        }
        return process(recording, robot, &processing).map_err(fault);
    }
    if !(arguments.skip.is_finite() && arguments.skip >= 0.0) {
        return Err(Fault::new(format!("--skip is {}, expected seconds not below zero", arguments.skip)).into());
    }
    let n = log.dof;
    let effort_unit = log.effort_unit.unwrap_or_else(|| robot.effort());
    let first = ((arguments.skip * log.rate_hz).round() as usize).min(log.q.len() / n);
    let (q, effort) = (&log.q[first * n..], &log.effort[first * n..]);
    let Some(period) = arguments.period else {
        let record = AperiodicRecord { dof: n, rate_hz: log.rate_hz, q, effort };
        let thinned = (4.0 * processing.cutoff_hz(0.0)).min(log.rate_hz);
        return process_aperiodic(&record, robot, effort_unit, thinned, &processing).map_err(fault);
    };
    let whole = period * log.rate_hz;
    let period_samples = whole.round();
    if !(period_samples >= 8.0 && (whole - period_samples).abs() < 1e-3) {
        let message = format!(
            "--period {period} s is {whole:.3} samples at the {} Hz of {}, expected a whole number of at least 8",
            log.rate_hz, log.name
        );
        return Err(Fault::new(message).into());
    }
    let period_samples = period_samples as usize;
    let periods = q.len() / (n * period_samples);
    if periods == 0 {
        let message = format!(
            "{} holds {:.3} s after --skip, expected at least one period of {period} s",
            log.name,
            (q.len() / n) as f64 / log.rate_hz
        );
        return Err(Fault::new(message).into());
    }
    let rows = 0..periods * period_samples * n;
    let record =
        PeriodicRecord { dof: n, rate_hz: log.rate_hz, period_samples, q: &q[rows.clone()], effort: &effort[rows] };
    process_periods(&record, robot, effort_unit, 0.0, &processing).map_err(fault)
}
