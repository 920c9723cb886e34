//! The part of `robot.toml` that tunes the simulated joint servo.

use serde::Deserialize;

use super::error::FormatError;
use super::reading::{Check, Number};
use crate::input::size::RATE_HZ;
use crate::model::servo::ServoTuning;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ServoTable {
    rate_hz: Number,
    bandwidth_hz: Number,
    damping: Number,
    integral_hz: Number,
    #[serde(default)]
    friction: bool,
}

/// The tuning.
pub(super) fn read_servo(check: Check<'_>, table: &ServoTable) -> Result<ServoTuning, FormatError> {
    if let Err(fault) = RATE_HZ.check("rate_hz", *table.rate_hz.get_ref()) {
        return check.fault(table.rate_hz.span(), fault.to_string());
    }
    Ok(ServoTuning {
        rate_hz: check.positive("rate_hz", &table.rate_hz)?,
        bandwidth_hz: check.positive("bandwidth_hz", &table.bandwidth_hz)?,
        damping: check.positive("damping", &table.damping)?,
        integral_hz: check.not_negative("integral_hz", &table.integral_hz)?,
        friction: table.friction,
    })
}
