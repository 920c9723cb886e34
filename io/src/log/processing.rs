//! From a log to samples of a robot.

use armid::diagnosis::standing_joints;
use armid::input::size::PERIOD_SAMPLES;
use armid::model::{EffortInterface, Robot};
use armid::remedy::{Remedy, Setting};
use armid::signal::{
    AperiodicRecord, PeriodicRecord, Processing, Samples, SignalError, process, process_aperiodic, process_periods,
    recurrence,
};

use super::arrangement::arranged;
use super::gaps::Gaps;
use super::joint_log::Log;
use super::processed_log::{LogReport, ProcessedLog};
use super::settings::LogSettings;
use crate::error::Error;
use crate::robot::LoadedRobot;

/// What there is to do about a period that does not fit.
fn no_period() -> Remedy {
    Remedy::from("with ").to(Setting::Period, "none").say(" the log is taken as a motion without periods")
}

/// Words, and the settings that cut a log.
pub(super) fn by_cuts(words: &str) -> Remedy {
    Remedy::from(words).setting(Setting::From).say(" and ").setting(Setting::Until)
}

/// Samples by which the last of the periods that are found in an even log may be off a whole number.
const LARGEST_SHIFT: f64 = 0.5;

/// Places of a resting joint that are this near are one, rad or m.
const SAME_REST: f64 = 2e-3;

/// Equations in a cycle of a cut-off that is stated.
const EQUATIONS_PER_CYCLE: f64 = 4.0;

/// Rate of the equations where the cut-off is found, Hz. Means over 25 ms take most noise of the acceleration out of them at any cut-off, and
/// leave out little near reversals.
const EQUATIONS_HZ: f64 = 40.0;

/// Periods of a log of which the last is held out.
const PERIODS_FOR_ONE: usize = 5;

impl Log {
    /// Samples of a robot: joints in its order, values at its joints, periods with missing samples left out, periods
    /// averaged; of a log that something else recorded, the last part held out.
    ///
    /// # Errors
    /// [`Error`] where the log is of other joints, its period is no whole number of samples, or nothing is left.
    pub fn process(self, robot: LoadedRobot, settings: &LogSettings) -> Result<ProcessedLog, Error> {
        self.processed(robot, settings, None)
    }

    /// The same, with a cut-off that was found in several logs.
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
/// As [`Log::process`] and [`ProcessedLog::joined`].
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
        ProcessedLog::joined(processed)
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

/// A recording of armid's own says itself what counts.
fn refuse_cuts(log: &Log, settings: &LogSettings) -> Result<(), Error> {
    if let Some(period) = settings.period_s {
        let message = format!("{} states its own period, found a period of {period} s", log.name);
        return Err(Error::new(message).help(Remedy::from("leave out ").setting(Setting::Period)));
    }
    if settings.from_s != 0.0 || settings.until_s.is_some() {
        let message = format!("{} states its recorded part, found times to begin or to end at", log.name);
        return Err(Error::new(message).help(by_cuts("leave out ")));
    }
    if settings.measured_velocity {
        let help = Remedy::from("leave out ").setting(Setting::MeasuredVelocity);
        return Err(Error::new(format!("{} holds no measured velocities", log.name)).help(help));
    }
    Ok(())
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

/// The period, and the part in which it repeats, of what settings leave of a log: as they are stated, or as they are found in it, which is remarked upon.
fn part_that_repeats(log: &mut Log, whole: Log, settings: &LogSettings) -> (Option<f64>, Log) {
    let states_part = settings.from_s > 0.0 || settings.until_s.is_some();
    let states_all = settings.period_s.is_some() && states_part;
    let [segment] = whole.segments[..] else { return (settings.period_s, whole) };
    if !settings.finds_period || states_all || settings.measured_velocity {
        return (settings.period_s, whole);
    }
    let rate_hz = whole.rate_hz;
    let Some(found) = recurrence(&whole.q, whole.dof, settings.period_s.map(|period_s| period_s * rate_hz)) else {
        return (settings.period_s, whole);
    };
    let mut samples = found.period_samples;
    // Uneven logs are brought onto a grid that the period fits; the samples of even ones stay.
    if settings.period_s.is_none() && log.origin.timing.as_ref().is_none_or(|timing| timing.even) {
        samples = samples.round();
        if (samples - found.period_samples).abs() * found.periods as f64 > LARGEST_SHIFT {
            return (None, whole);
        }
    }
    let (period_s, from_s) = (samples / rate_hz, segment.start_s + found.first as f64 / rate_hz);
    let periods = found.periods;
    log.origin.remarks.push(match settings.period_s {
        Some(_) => format!("{periods} periods of {period_s:.1} s found, from {from_s:.1} s"),
        None => format!("{period_s:.1} s period found, {periods} of them from {from_s:.1} s"),
    });
    // A grid of another step may need the sample behind the last.
    let end = (found.first + (periods as f64 * samples).ceil() as usize + 1).min(segment.samples);
    (Some(period_s), whole.pieces(|_, _| (found.first, end)))
}

/// The times to begin and to end at leave no sample.
fn nothing_left(log: &Log, settings: &LogSettings) -> Error {
    let end =
        log.segments.last().map_or(0.0, |last| last.start_s + last.samples.saturating_sub(1) as f64 / log.rate_hz);
    let asked = Remedy::set(Setting::From, settings.from_s.to_string());
    let asked = match settings.until_s {
        Some(until) => asked.say(" ").to(Setting::Until, until.to_string()),
        None => asked,
    };
    let message = format!("{asked} leaves nothing of {}, which spans 0 to {end:.3} s", log.name);
    Error::new(message).help("both count in seconds from the first sample of the log, whatever its stamps are")
}

/// What there is to do about a cut-off frequency that the rate of a log does not allow.
fn below_nyquist(error: &SignalError, log: &Log) -> Option<Remedy> {
    let SignalError::Cutoff { nyquist, .. } = error else { return None };
    // Two digits, rounded down, so that it stays below.
    let wanted = 0.8 * nyquist;
    let digit = 10_f64.powi(wanted.log10().floor() as i32 - 1);
    let wanted = (wanted / digit).floor() * digit;
    let (wanted, rate_hz) = ((wanted * 1e6).round() / 1e6, (log.rate_hz * 1e3).round() / 1e3);
    let help = Remedy::set(Setting::CutoffHz, wanted.to_string());
    let help = help.say(format!(" is one that a log of {rate_hz} Hz allows"));
    Some(if log.rate_hz < 5.0 {
        help.say("; are the stamps milliseconds? then ").to(Setting::Map, "t=… ms, …").say(" says so")
    } else {
        help
    })
}

/// Cut-off and rate of the equations of a log without periods, Hz. A cut-off that is found in it, or in several, is remarked upon.
fn low_pass(log: &mut Log, whole: &Log, settings: &LogSettings, common_hz: Option<f64>) -> [f64; 2] {
    if let Some(hz) = settings.processing.cutoff_hz {
        return [hz, EQUATIONS_PER_CYCLE * hz];
    }
    let segments: Vec<usize> = whole.segments.iter().map(|segment| segment.samples).collect();
    let hz = common_hz.unwrap_or_else(|| record(whole, &segments, settings).find_cutoff());
    let of = if common_hz.is_some() { "of these logs" } else { "of this log" };
    let series = if settings.measured_velocity { "velocities" } else { "positions" };
    log.origin.remarks.push(format!("low pass of {hz:.1} Hz for the {series}, by the noise {of}"));
    [hz, EQUATIONS_HZ]
}

fn record<'a>(log: &'a Log, segments: &'a [usize], settings: &LogSettings) -> AperiodicRecord<'a> {
    AperiodicRecord {
        qd: log.qd.as_deref().filter(|_| settings.measured_velocity),
        segments,
        excluded: &log.excluded,
        ..AperiodicRecord::new(log.dof, log.rate_hz, &log.q, &log.effort)
    }
}

/// Samples of a part of a log.
fn aperiodic(
    log: &Log,
    robot: &Robot,
    settings: &LogSettings,
    [cutoff_hz, rate_hz]: [f64; 2],
) -> Result<Samples, Error> {
    // A cut-off that is stated leaves the rows as they are: so is a fit repeated that was made elsewhere.
    let reversal_cycles = match settings.processing.cutoff_hz {
        Some(_) => 0.0,
        None => settings.processing.reversal_cycles,
    };
    let processing = &Processing { cutoff_hz: Some(cutoff_hz), reversal_cycles, ..settings.processing.clone() };
    let segments: Vec<usize> = log.segments.iter().map(|segment| segment.samples).collect();
    let record = record(log, &segments, settings);
    let unit = log.effort_unit.unwrap_or_else(|| robot.effort());
    let thinned = rate_hz.min(log.rate_hz);
    let fault = |error| Error::new(format!("{}: {error}", log.name)).maybe_help(below_nyquist(&error, log));
    let samples = process_aperiodic(&record, robot, unit, thinned, processing).map_err(fault)?;
    let Some(link_q) = &log.link_q else { return Ok(samples) };
    let record = AperiodicRecord { q: link_q, qd: None, ..record };
    let of_links = process_aperiodic(&record, robot, unit, thinned, processing).map_err(fault)?;
    Ok(samples.with_link_positions(&of_links))
}

fn periodic(
    log: &Log,
    robot: &Robot,
    settings: &LogSettings,
    period: f64,
    share: f64,
) -> Result<(Samples, Option<Samples>), Error> {
    if settings.measured_velocity {
        let message = format!("{}: velocities of a motion with a period come from its positions", log.name);
        return Err(Error::new(message).help(
            Remedy::from("leave out ").setting(Setting::MeasuredVelocity).say(", or ").setting(Setting::Period),
        ));
    }
    let even = log.origin.timing.as_ref().is_none_or(|timing| timing.even);
    let log = &if even {
        log.pieces(|segment, _| (0, segment.samples))
    } else {
        log.resampled((period * log.rate_hz).round().max(1.0) / period)
    };
    let whole = period * log.rate_hz;
    let period_samples = whole.round();
    PERIOD_SAMPLES.check("number of samples of a period", period_samples)?;
    if !(period_samples >= 8.0 && (whole - period_samples).abs() < 1e-3) {
        let message = format!(
            "a period of {period} s is {whole:.3} samples at the {} Hz of {}, expected a whole number of at least 8",
            log.rate_hz, log.name
        );
        return Err(Error::new(message).help(no_period()));
    }
    let period_samples = period_samples as usize;
    let mut starts = Vec::new();
    let mut before = 0;
    let begin = log.segments.first().map_or(0.0, |segment| segment.start_s);
    for segment in &log.segments {
        // Periods are counted from the beginning of the log: those that a break cuts are left out.
        let phase = ((segment.start_s - begin) * log.rate_hz).round() as usize;
        let mut first = (period_samples - phase % period_samples) % period_samples;
        while first + period_samples <= segment.samples {
            starts.push(before + first);
            first += period_samples;
        }
        before += segment.samples;
    }
    if starts.is_empty() {
        let message = format!(
            "{} holds {:.3} s after those that are skipped, expected at least one period of {period} s",
            log.name,
            log.len() as f64 / log.rate_hz
        );
        return Err(Error::new(message).help(no_period()));
    }
    let aside = if settings.held_out.is_share() {
        (share * starts.len() as f64).round() as usize
    } else if share > 0.0 {
        // Whoever states no period gets a number for the prediction all the same.
        (starts.len() / PERIODS_FOR_ONE).max(usize::from(settings.period_s.is_none()))
    } else {
        0
    };
    let (used, aside) = starts.split_at(starts.len() - aside.min(starts.len() - 1));
    let average = |starts: &[usize]| average(log, robot, settings, starts, period_samples);
    Ok((average(used)?, if aside.is_empty() { None } else { Some(average(aside)?) }))
}

/// The average of the periods that begin at these samples.
fn average(log: &Log, robot: &Robot, settings: &LogSettings, starts: &[usize], count: usize) -> Result<Samples, Error> {
    let n = log.dof;
    let pick = |table: &[f64]| -> Vec<f64> {
        starts.iter().flat_map(|&first| table[first * n..(first + count) * n].iter().copied()).collect()
    };
    let (q, effort) = (pick(&log.q), pick(&log.effort));
    let record = PeriodicRecord { dof: n, rate_hz: log.rate_hz, period_samples: count, q: &q, effort: &effort };
    let unit = log.effort_unit.unwrap_or_else(|| robot.effort());
    let process = |record: &PeriodicRecord<'_>| {
        process_periods(record, robot, unit, 0.0, &settings.processing)
            .map_err(|error| Error::new(format!("{}: {error}", log.name)).maybe_help(below_nyquist(&error, log)))
    };
    let mut samples = process(&record)?;
    if let Some(link_q) = log.link_q.as_deref().map(pick) {
        samples = samples.with_link_positions(&process(&PeriodicRecord { q: &link_q, ..record })?);
    }
    if !log.excluded.is_empty() {
        // What was at fault in one period is in the average.
        let block = samples.block;
        for (at, (used, slow)) in samples.used.iter_mut().zip(&mut samples.slow).enumerate() {
            let (m, i) = (at / n, at % n);
            let at_fault = |first: usize| (m * block..(m + 1) * block).any(|k| log.excluded[(first + k) * n + i]);
            let sound = !starts.iter().any(|&first| at_fault(first));
            (*used, *slow) = (*used && sound, *slow && sound);
        }
    }
    Ok(samples)
}
