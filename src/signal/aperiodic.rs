//! A record without periods: the whole of it filtered and differentiated.

use super::error::check_finite;
use super::periodic::{column, effort_units, put_column, used_blocks};
use super::torque::{map_rows, torque_map};
use super::{Butterworth, Derivatives, Processing, Samples, SignalError, TorqueFilter, differences};
use crate::dynamics::States;
use crate::model::{EffortInterface, Robot};

/// A record of any motion: `q` and `effort` are N × n, row-major.
#[derive(Clone, Copy, Debug)]
pub struct AperiodicRecord<'a> {
    /// Number of joints n.
    pub dof: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Positions, rad or m.
    pub q: &'a [f64],
    /// Efforts, in the unit that the arm reports.
    pub effort: &'a [f64],
}

/// Processes a record without periods by zero-phase low pass and central differences. `rate_hz` is the rate of the
/// equations, Hz: blocks of samples are averaged to come near it.
///
/// There is no scatter to see noise in, so the result carries none, and estimators take it from their residual. The
/// cut-off is [`Processing::cutoff_hz`], 10 Hz where nothing is stated.
///
/// # Errors
/// [`SignalError`] where the record is malformed, shorter than 8 samples, or a setting does not fit it.
pub fn process_aperiodic(
    record: &AperiodicRecord<'_>,
    robot: &Robot,
    effort: EffortInterface,
    rate_hz: f64,
    processing: &Processing,
) -> Result<Samples, SignalError> {
    processing.check()?;
    let n = record.dof;
    if robot.dof() != n {
        return Err(SignalError::Joints { found: n, expected: robot.dof() });
    }
    let len = record.q.len() / n;
    if len < 8 || !record.q.len().is_multiple_of(n) {
        let (found, least) = (record.q.len(), 8 * n);
        return Err(SignalError::Length { quantity: "positions", found, block: n, of: "joints", least });
    }
    if record.effort.len() != record.q.len() {
        let (found, expected) = (record.effort.len(), record.q.len());
        return Err(SignalError::Unequal { quantity: "efforts", found, other: "positions", expected });
    }
    check_finite("position", record.q, n)?;
    check_finite("effort", record.effort, n)?;
    let cutoff_hz = processing.cutoff_hz(0.0);
    let filter = Butterworth::new(processing.filter_order, cutoff_hz, record.rate_hz)?;
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(SignalError::Setting {
            setting: "rate of the equations",
            found: format!("{rate_hz} Hz"),
            expected: "a finite number above zero",
        });
    }
    let mut tau = map_rows(record.effort, &torque_map(robot, effort));
    let mut states = States::with_len(n, len);
    let same = processing.torque_filter == TorqueFilter::SameAsPositions;
    for i in 0..n {
        let q = filter.zero_phase_reflected(&column(record.q, n, i));
        let (qd, qdd) = differences(&q, 1.0 / record.rate_hz);
        put_column(&mut states.q, n, i, &q);
        put_column(&mut states.qd, n, i, &qd);
        put_column(&mut states.qdd, n, i, &qdd);
        if same {
            let filtered = filter.zero_phase_reflected(&column(&tau, n, i));
            put_column(&mut tau, n, i, &filtered);
        }
    }
    let block = ((record.rate_hz / rate_hz).round() as usize).clamp(1, len / 8);
    Ok(Samples {
        used: used_blocks(&states, block, processing.reversal_fraction),
        states,
        tau,
        units: effort_units(robot),
        block,
        rate_hz: record.rate_hz,
        period_s: None,
        periods: 1,
        torque_covariance: None,
        position_noise: None,
        noise: None,
        derivatives: Derivatives::Differences,
        position_band_hz: vec![cutoff_hz; n],
        torque_band_hz: same.then_some(cutoff_hz),
        provenance: None,
    })
}
