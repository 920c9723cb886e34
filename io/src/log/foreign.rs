//! Joint states that something else recorded.

use armid::cdr::JointState;

use super::conversion::Conversion;
use super::joint_log::Log;
use super::origin::Origin;
use super::raw_log::RawLog;
use super::state_table::{columns, velocities};
use crate::error::Error;

/// A log whose times are the stamps of its messages.
pub(super) fn log(name: &str, states: &[JointState]) -> Result<Log, Error> {
    let joints = states[0].name.clone();
    let (q, effort) = columns(name, &joints, states)?;
    let first = states[0].stamp.ns();
    let raw = RawLog {
        name: name.to_owned(),
        dof: joints.len(),
        t: states.iter().map(|state| (i128::from(state.stamp.ns()) - i128::from(first)) as f64 * 1e-9).collect(),
        rate_hz: None,
        qd: velocities(&joints, states),
        joints: Some(joints),
        q,
        effort,
        effort_unit: None,
        conversion: Conversion::default(),
        origin: Origin::default(),
    };
    raw.even(|row, message| Error::new(format!("{name}: message {}: {message}", row + 1)))
}
