//! From a log to samples of a robot: what `identify` and `validate` share.

use std::path::Path;

use armid::signal::{
    AperiodicRecord, Derivatives, PeriodicRecord, Processing, Samples, SignalError, process, process_aperiodic,
    process_periods,
};
use miette::Result;

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
    #[arg(long, value_name = "N", default_value_t = 1000, help_heading = "Processing")]
    pub(crate) samples: usize,
}

/// A log that has become samples.
pub(crate) struct Prepared {
    pub(crate) log: Log,
    pub(crate) robot: LoadedRobot,
    pub(crate) samples: Samples,
}

/// Reads a log and processes it.
pub(crate) fn prepare(path: &Path, arguments: &LogArguments) -> Result<Prepared> {
    let log = log::read(path)?;
    let robot = robot(&log, arguments)?;
    check(&log, &robot)?;
    let samples = samples(&log, &robot, arguments)?;
    Ok(Prepared { log, robot, samples })
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

fn check(log: &Log, loaded: &LoadedRobot) -> Result<()> {
    let robot = &loaded.robot;
    if log.dof != robot.dof() {
        let message = format!(
            "{} holds {} joints, expected the {} of robot \"{}\"",
            log.name,
            log.dof,
            robot.dof(),
            robot.name()
        );
        return Err(Fault::new(message).into());
    }
    let expected: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    match &log.joints {
        Some(joints) if *joints != expected => {
            let message = format!(
                "{} holds the joints {}, expected {} of robot \"{}\"",
                log.name,
                joints.join(", "),
                expected.join(", "),
                robot.name()
            );
            Err(Fault::new(message).into())
        }
        _ => Ok(()),
    }
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
