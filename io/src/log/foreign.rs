//! Joint states that something else recorded.

use std::collections::BTreeMap;

use armid::cdr::JointState;

use super::joint_log::Log;
use super::state_table::columns;
use crate::error::Error;

/// A log whose rate comes from the stamps.
pub(super) fn log(name: &str, states: &[JointState]) -> Result<Log, Error> {
    let joints = states[0].name.clone();
    let (q, effort) = columns(name, &joints, states)?;
    let n = states.len();
    if n < 2 {
        return Err(Error::new(format!("{name} has {n} sample, expected at least 2")));
    }
    let (first, last) = (states[0].stamp.ns(), states[n - 1].stamp.ns());
    if last <= first {
        return Err(Error::new(format!("{name}: time goes from {first} to {last} ns, expected it to rise")));
    }
    let rate = (n - 1) as f64 / ((last - first) as f64 * 1e-9);
    let whole = rate.round();
    // The stamps of a real robot jitter: a rate within a thousandth of a whole number of Hz is meant to be that.
    let rate_hz = if whole > 0.0 && (rate / whole - 1.0).abs() < 1e-3 { whole } else { rate };
    Ok(Log {
        name: name.to_owned(),
        dof: joints.len(),
        joints: Some(joints),
        rate_hz,
        effort_unit: None,
        q,
        effort,
        robot: None,
        recording: None,
        notes: BTreeMap::new(),
        complete: true,
    })
}
