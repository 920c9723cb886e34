//! The part of `robot.toml` that says how motors are coupled.
//!
//! ```text
//! [coupling]
//! motor_from_joint = [[1, 0], [-0.4, 1]]      # row by row, one row for each motor
//! ```

use nalgebra::DMatrix;
use serde::Deserialize;
use toml::Spanned;

use super::error::FormatError;
use super::reading::{Check, Row};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CouplingTable {
    motor_from_joint: Spanned<Vec<Row>>,
}

/// Reads it for a robot of `n` joints.
pub(super) fn read_coupling(check: Check<'_>, table: &CouplingTable, n: usize) -> Result<DMatrix<f64>, FormatError> {
    let rows = table.motor_from_joint.get_ref();
    let whole = table.motor_from_joint.span();
    if rows.len() != n {
        return check.fault(whole, format!("motor_from_joint has {} rows, expected {n}, one per motor", rows.len()));
    }
    let mut matrix = DMatrix::zeros(n, n);
    for (i, row) in rows.iter().enumerate() {
        if row.get_ref().len() != n {
            let found = row.get_ref().len();
            return check
                .fault(row.span(), format!("row {} of motor_from_joint has {found} numbers, expected {n}", i + 1));
        }
        for (j, number) in row.get_ref().iter().enumerate() {
            matrix[(i, j)] = check.finite("motor_from_joint", number)?;
        }
    }
    if matrix.clone().try_inverse().is_none() {
        return check.fault(whole, "motor_from_joint is singular, expected a matrix with an inverse");
    }
    Ok(matrix)
}
