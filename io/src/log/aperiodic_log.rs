//! Samples of a log without periods.

use armid::model::Robot;
use armid::signal::{AperiodicRecord, Processing, Samples, process_aperiodic};

use super::joint_log::Log;
use super::low_pass::below_nyquist;
use super::settings::LogSettings;
use crate::error::Error;

/// Equations in a cycle of a cut-off that is stated.
const EQUATIONS_PER_CYCLE: f64 = 4.0;

/// Rate of the equations where the cut-off is found, Hz. Means over 25 ms take most noise of the acceleration out of them at any cut-off, and
/// leave out little near reversals.
const EQUATIONS_HZ: f64 = 40.0;

/// Cut-off and rate of the equations of a log without periods, Hz. A cut-off that is found in it, or in several, is remarked upon.
pub(super) fn low_pass(log: &mut Log, whole: &Log, settings: &LogSettings, common_hz: Option<f64>) -> [f64; 2] {
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
pub(super) fn aperiodic(
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
