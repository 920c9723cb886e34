//! A cut-off frequency that the rate of a log does not allow.

use armid::remedy::{Remedy, Setting};
use armid::signal::SignalError;

use super::joint_log::Log;

/// What there is to do about a cut-off frequency that the rate of a log does not allow.
pub(super) fn below_nyquist(error: &SignalError, log: &Log) -> Option<Remedy> {
    let SignalError::Cutoff { nyquist, .. } = error else { return None };
    // Two digits, rounded down, so that it stays below.
    let wanted = 0.8 * nyquist;
    let digit = 10_f64.powi(wanted.log10().floor() as i32 - 1);
    let wanted = (wanted / digit).floor() * digit;
    let (wanted, rate_hz) = ((wanted * 1e6).round() / 1e6, (log.rate_hz * 1e3).round() / 1e3);
    let help = Remedy::set(Setting::CutoffHz, wanted.to_string());
    let help = help.say(format!(" is one that a log of {rate_hz} Hz allows"));
    Some(if log.rate_hz < 5.0 {
        help.say("; are the stamps milliseconds? then ").assign(Setting::Map, "t=… ms, …").say(" says so")
    } else {
        help
    })
}
