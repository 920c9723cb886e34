//! From a log to samples of a robot.

use armid::diagnosis::standing_joints;
use armid::input::size::PERIOD_SAMPLES;
use armid::model::EffortInterface;
use armid::remedy::{Remedy, Setting};
use armid::signal::{Samples, SignalError, process};

use super::aperiodic_log::{aperiodic, low_pass};
use super::arrangement::arranged;
use super::gaps::Gaps;
use super::joint_log::Log;
use super::log_report::LogReport;
use super::periodic_log::periodic;
use super::processed_log::ProcessedLog;
use super::settings::LogSettings;
use super::used_part::{nothing_left, part_that_repeats, refuse_cuts};
use crate::error::Error;
use crate::robot::LoadedRobot;

/// Places of a resting joint that are this near are one, rad or m.
const SAME_REST: f64 = 2e-3;

impl Log {
    /// Samples of a robot: joints in its order, values at its joints, periods with missing samples left out, periods
    /// averaged; of a log that something else recorded, the last part held out.
    ///
    /// # Errors
    /// [`Error`] where the log is of other joints, its period is no whole number of samples, or nothing is left.
    pub fn process(self, robot: LoadedRobot, settings: &LogSettings) -> Result<ProcessedLog, Error> {
        self.processed(robot, settings, None)
    }

    /// Processes a log with a cut-off that was found in several logs.
    fn processed(
        self,
        robot: LoadedRobot,
        settings: &LogSettings,
        common_hz: Option<f64>,
    ) -> Result<ProcessedLog, Error> {
        let kept = settings.processing.samples_per_period;
        PERIOD_SAMPLES.check_count("number of samples that a period is reduced to", kept)?;
        let mut log = arranged(self, &robot.robot)?;
        log.bring_to_joints(&robot.robot)?;
        let gaps = Gaps::leave_out(&mut log)?;
        let fault = |error: SignalError| -> Error { Error::new(format!("{}: {error}", log.name)) };
        let (used, held_out) = if let Some(recording) = &log.recording {
            refuse_cuts(&log, settings)?;
            (process(recording, &robot.robot, &settings.processing).map_err(fault)?, None)
        } else {
            let (used, held_out) = foreign(&mut log, &robot, settings, common_hz)?;
            // What a joint at rest shows is estimated with it at rest.
            let at_rest = standing_joints(&used);
            (used.with_joints_at_rest(&at_rest), held_out.map(|samples| samples.with_joints_at_rest(&at_rest)))
        };
        let report = LogReport::new(&log, gaps, &used, held_out.as_ref());
        Ok(ProcessedLog {
            samples: used.clone(),
            parts: vec![used],
            held_out: held_out.into_iter().collect(),
            reports: vec![report],
            logs: vec![log],
            settings: settings.clone(),
            closed_loops: None,
            start: None,
            robot,
        })
    }
}

/// Samples of several logs of one robot. Logs that something else recorded at unlike rates are brought onto the lowest of them, and those
/// without periods pass the highest of the cut-offs that are found in them.
///
/// # Errors
/// As [`Log::process`] and [`ProcessedLog::join`].
pub fn process_all(logs: Vec<Log>, robot: &LoadedRobot, settings: &LogSettings) -> Result<ProcessedLog, Error> {
    let foreign = |log: &&Log| log.recording.is_none();
    let lowest = logs.iter().filter(foreign).map(|log| log.rate_hz).fold(f64::INFINITY, f64::min);
    let alike = logs.into_iter().map(|mut log| {
        if log.recording.is_none() && log.rate_hz > lowest * (1.0 + 1e-9) {
            let remark = format!("brought from {} Hz onto {lowest} Hz, the lowest rate of the logs", log.rate_hz);
            log = log.resampled(lowest);
            log.origin.remarks.push(remark);
        }
        log
    });
    let alike: Vec<Log> = alike.collect();
    let process = |logs: Vec<Log>, common_hz| {
        let processed = logs.into_iter().map(|log| log.processed(robot.clone(), settings, common_hz));
        processed.collect::<Result<Vec<_>, Error>>()
    };
    let joined = |mut processed: Vec<ProcessedLog>| {
        share_rests(&mut processed, robot.robot.dof());
        ProcessedLog::join(processed)
    };
    if alike.len() == 1 || settings.processing.cutoff_hz.is_some() {
        return joined(process(alike, None)?);
    }
    let apart = process(alike.clone(), None)?;
    let found: Vec<f64> =
        apart.iter().filter(|log| log.has_no_periods()).map(|log| log.samples.position_band_hz[0]).collect();
    let highest = found.iter().copied().fold(0.0, f64::max);
    joined(if found.iter().any(|hz| *hz < highest) { process(alike, Some(highest))? } else { apart })
}

/// Gives a joint that rests in several logs at the same place, but for its noise, one place: equations would take the differences for motion.
fn share_rests(logs: &mut [ProcessedLog], n: usize) {
    for joint in 0..n {
        let mut rests: Vec<(f64, &mut Samples)> = logs
            .iter_mut()
            .filter(|log| log.logs.iter().all(|log| log.recording.is_none()))
            .flat_map(|log| [&mut log.samples].into_iter().chain(&mut log.parts).chain(&mut log.held_out))
            .filter(|samples| standing_joints(samples).contains(&(joint + 1)))
            .map(|samples| (samples.states.q[joint], samples))
            .collect();
        rests.sort_by(|a, b| a.0.total_cmp(&b.0));
        for same in rests.chunk_by_mut(|a, b| b.0 - a.0 < SAME_REST) {
            let place = same.iter().map(|(place, _)| place).sum::<f64>() / same.len() as f64;
            for (_, samples) in same {
                samples.states.q.iter_mut().skip(joint).step_by(n).for_each(|q| *q = place);
            }
        }
    }
}

/// Samples that are used, and those that are held out.
fn foreign(
    log: &mut Log,
    robot: &LoadedRobot,
    settings: &LogSettings,
    common_hz: Option<f64>,
) -> Result<(Samples, Option<Samples>), Error> {
    let (from, until) = (settings.from_s, settings.until_s.unwrap_or(f64::INFINITY));
    if !(from.is_finite() && from >= 0.0) {
        return Err(Error::new(format!("skip is {from} s, expected seconds not below zero")));
    }
    if until.is_nan() || until <= from {
        return Err(Error::new(format!(
            "the part of the log ends at {until} s, expected more than its beginning, {from} s"
        )));
    }
    let share = settings.held_out.share(true);
    if !(0.0..=0.9).contains(&share) {
        return Err(Error::new(format!("the part that is held out is {share}, expected 0 to 0.9")));
    }
    if settings.measured_velocity && log.qd.is_none() {
        let message = format!("{} holds no measured velocities, expected a column qd for each joint", log.name);
        let help = Remedy::set(Setting::Map, "…, qd=velocity_[1-6]").say(" says which they are, or leave out ");
        return Err(Error::new(message).help(help.setting(Setting::MeasuredVelocity)));
    }
    // A robot that says what its efforts are decides where the log does not.
    let unit = match log.effort_unit {
        // Currents with constants are torques by now, whatever is said of the efforts of the log.
        Some(unit) if log.origin.has_constants() => unit,
        stated => settings.effort.or(stated).unwrap_or_else(|| robot.robot.effort()),
    };
    log.effort_unit = Some(unit);
    if unit == EffortInterface::Current {
        log.exclude_coupled(&robot.robot);
    }
    robot.check_constants(unit, &log.name, log.origin.with_constants().as_deref())?;
    let whole = log.between(from, until);
    if whole.is_empty() {
        return Err(nothing_left(log, settings));
    }
    let (period, whole) = part_that_repeats(log, whole, settings);
    match period {
        Some(period) => periodic(&whole, &robot.robot, settings, period, share),
        None => {
            let low_pass = low_pass(log, &whole, settings, common_hz);
            let (used, aside) = whole.split(whole.len() - (share * whole.len() as f64).round() as usize);
            let samples = |part: &Log| aperiodic(part, &robot.robot, settings, low_pass);
            Ok((samples(&used)?, if aside.is_empty() { None } else { Some(samples(&aside)?) }))
        }
    }
}
