//! Base parameters of a robot.

use armid::base::Method;
use armid_io::Error;
use armid_workflow::{ReductionSettings, reduce as reduced};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::fault::{exception, unexpected};
use crate::robot::Robot;

/// The answer of the command, and K, b × p.
#[pyfunction]
pub(crate) fn reduce<'py>(
    py: Python<'py>,
    robot: &Robot,
    columns: &str,
    trajectory: Option<String>,
    method: Option<&str>,
    seed: u64,
) -> PyResult<(String, Bound<'py, PyArray2<f64>>)> {
    let method = method.map(|name| {
        let names = || Method::ALL.map(Method::name).join(", ");
        let found = Method::ALL.into_iter().find(|method| method.name() == name);
        found.ok_or_else(|| unexpected(format!("method is \"{name}\", expected one of {}", names())))
    });
    let settings = ReductionSettings {
        columns: robot.columns(columns)?,
        method: method.transpose()?,
        trajectory,
        seed,
        ..ReductionSettings::default()
    };
    let answer = py.detach(|| {
        let answer = reduced(&robot.loaded, &settings)?;
        Ok((serde_json::to_string(&answer).map_err(Error::new)?, answer.base.k))
    });
    let (text, k) = answer.map_err(exception)?;
    let rows = k.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>());
    let k = PyArray1::from_iter(py, rows).reshape([k.nrows(), k.ncols()])?;
    Ok((text, k))
}
