//! Columns of row-major tables: one joint's numbers of all samples.

use crate::dynamics::States;

/// Column `i` of a row-major table n wide.
pub(super) fn column(rows: &[f64], n: usize, i: usize) -> Vec<f64> {
    rows.iter().skip(i).step_by(n).copied().collect()
}

/// Writes the motion of joint `i`.
pub(super) fn put_motion(states: &mut States, i: usize, motion: [&[f64]; 3]) {
    for (rows, values) in [&mut states.q, &mut states.qd, &mut states.qdd].into_iter().zip(motion) {
        put_column(rows, states.dof, i, values);
    }
}

/// Writes column `i` of a row-major table n wide.
pub(super) fn put_column(rows: &mut [f64], n: usize, i: usize, values: &[f64]) {
    for (to, value) in rows.iter_mut().skip(i).step_by(n).zip(values) {
        *to = *value;
    }
}
