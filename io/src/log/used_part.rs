//! Which part of a log is used.

use armid::remedy::{Remedy, Setting};
use armid::signal::recurrence;

use super::joint_log::Log;
use super::settings::LogSettings;
use crate::error::Error;

/// Samples by which the last of the periods that are found in an even log may be off a whole number.
const LARGEST_SHIFT: f64 = 0.5;

/// Words, and the settings that cut a log.
pub(super) fn by_cuts(words: &str) -> Remedy {
    Remedy::from(words).setting(Setting::From).say(" and ").setting(Setting::Until)
}

/// A recording of armid's own says itself what counts.
pub(super) fn refuse_cuts(log: &Log, settings: &LogSettings) -> Result<(), Error> {
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

/// The period, and the part in which it repeats, of what settings leave of a log: as they are stated, or as they are found in it, which is remarked upon.
pub(super) fn part_that_repeats(log: &mut Log, whole: Log, settings: &LogSettings) -> (Option<f64>, Log) {
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
pub(super) fn nothing_left(log: &Log, settings: &LogSettings) -> Error {
    let end =
        log.segments.last().map_or(0.0, |last| last.start_s + last.samples.saturating_sub(1) as f64 / log.rate_hz);
    let asked = Remedy::set(Setting::From, settings.from_s.to_string());
    let asked = match settings.until_s {
        Some(until) => asked.say(" ").assign(Setting::Until, until.to_string()),
        None => asked,
    };
    let message = format!("{asked} leaves nothing of {}, which spans 0 to {end:.3} s", log.name);
    Error::new(message).help("both count in seconds from the first sample of the log, whatever its stamps are")
}
