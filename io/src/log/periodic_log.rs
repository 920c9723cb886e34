//! Samples of a log whose motion repeats.

use armid::input::size::PERIOD_SAMPLES;
use armid::model::Robot;
use armid::remedy::{Remedy, Setting};
use armid::signal::{PeriodicRecord, Samples, process_periods};

use super::joint_log::Log;
use super::low_pass::below_nyquist;
use super::settings::LogSettings;
use crate::error::Error;

/// Periods of a log of which the last is held out.
const PERIODS_FOR_ONE: usize = 5;

/// What there is to do about a period that does not fit.
fn no_period() -> Remedy {
    Remedy::from("with ").assign(Setting::Period, "none").say(" the log is taken as a motion without periods")
}

/// Samples of the periods of a part of a log that are used, and of those that are held out, a `share` of them.
pub(super) fn periodic(
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
