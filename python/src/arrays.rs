//! Arrays of NumPy, checked before anything reads them.

use numpy::{PyReadonlyArray2, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::fault::unexpected;

/// Values of N rows and n joints, as Python hands them over.
pub(crate) type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// The values of an array, row by row: of `dof` joints, each a finite number.
///
/// # Errors
/// `ArmidError` with the shape, or with the first value that is no finite number and where it is.
pub(crate) fn finite<'a>(rows: &'a Rows<'_>, name: &str, dof: usize) -> PyResult<&'a [f64]> {
    let values = any(rows, name, dof)?;
    // All at once, which is several at a time; then the first that is not.
    if !values.iter().fold(true, |all, value| all & value.is_finite())
        && let Some(at) = values.iter().position(|value| !value.is_finite())
    {
        let (value, row, joint) = (values[at], at / dof, at % dof);
        return Err(unexpected(format!("{name}[{row}, {joint}] is {value}, expected a finite number")));
    }
    Ok(values)
}

/// The values of an array, row by row, of `dof` joints; a missing one is NaN.
///
/// # Errors
/// `ArmidError` with the shape.
pub(crate) fn any<'a>(rows: &'a Rows<'_>, name: &str, dof: usize) -> PyResult<&'a [f64]> {
    let shape = rows.shape();
    if shape[1] != dof {
        return Err(unexpected(format!("{name} has the shape {shape:?}, expected N rows of {dof} joints")));
    }
    rows.as_slice().map_err(|_| unexpected(format!("{name} is not contiguous")))
}

/// Several arrays of as many rows.
///
/// # Errors
/// `ArmidError` with both lengths.
pub(crate) fn check_lengths(arrays: &[(&str, &Rows<'_>)]) -> PyResult<()> {
    let Some(((first, expected), others)) = arrays.split_first() else { return Ok(()) };
    let expected = expected.shape()[0];
    match others.iter().find(|(_, rows)| rows.shape()[0] != expected) {
        Some((name, rows)) => {
            let found = rows.shape()[0];
            Err(unexpected(format!("{name} has {found} rows, expected {expected} as {first} has")))
        }
        None => Ok(()),
    }
}

/// Positions, velocities and accelerations of `dof` joints, row by row.
///
/// # Errors
/// As [`finite`] and [`check_lengths`].
pub(crate) fn samples_of<'a>(dof: usize, [q, qd, qdd]: [&'a Rows<'_>; 3]) -> PyResult<[&'a [f64]; 3]> {
    check_lengths(&[("q", q), ("qd", qd), ("qdd", qdd)])?;
    Ok([finite(q, "q", dof)?, finite(qd, "qd", dof)?, finite(qdd, "qdd", dof)?])
}

/// Where a result of this shape goes.
///
/// # Errors
/// `ArmidError` where the array has another shape.
pub(crate) fn output<'a>(out: &'a mut PyReadwriteArrayDyn<'_, f64>, shape: &[usize]) -> PyResult<&'a mut [f64]> {
    if out.shape() != shape {
        return Err(unexpected(format!("out has the shape {:?}, expected {shape:?}", out.shape())));
    }
    out.as_slice_mut().map_err(|_| unexpected("out is not contiguous"))
}
