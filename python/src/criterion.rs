//! A criterion that is written in Python.

use std::sync::Arc;

use armid::excitation::Criterion;
use armid::excitation::criterion::Score;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::callable::{Callable, numbers};
use crate::fault::unexpected;

/// A callable `M → (value, S)` with `d value = tr(S dM)`, which is minimised. What it raises ends the search.
#[derive(Clone, Debug)]
pub(crate) struct PythonCriterion(Arc<Callable>);

impl PythonCriterion {
    pub(crate) fn new(name: String, function: Py<PyAny>) -> Self {
        Self(Arc::new(Callable::new(name, function)))
    }

    /// As one of several criteria.
    pub(crate) fn shared(&self) -> Arc<dyn Criterion> {
        Arc::new(self.clone())
    }

    pub(crate) fn has_raised(&self) -> bool {
        self.0.has_raised()
    }

    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.0.raised()
    }

    /// The value, and the symmetric part of S: that of the rest with a symmetric dM is zero.
    fn call(&self, py: Python<'_>, m: &DMatrix<f64>) -> PyResult<(f64, DMatrix<f64>)> {
        let b = m.nrows();
        // M is symmetric: its columns are its rows.
        let information = PyArray1::from_slice(py, m.as_slice()).reshape([b, b])?;
        let answer = self.0.function.bind(py).call1((information,))?;
        let name = &self.0.name;
        let (value, s): (f64, Bound<'_, PyAny>) = answer.extract().map_err(|_| {
            unexpected(format!("criterion {name} did not return (value, S), expected a number and an array"))
        })?;
        if value.is_nan() {
            return Err(unexpected(format!("the value of criterion {name} is NaN, expected a number")));
        }
        let rows: Vec<Vec<f64>> = numbers(&s)?.extract()?;
        if rows.len() != b || rows.iter().any(|row| row.len() != b) {
            let columns = rows.first().map_or(0, Vec::len);
            let found = rows.len();
            return Err(unexpected(format!(
                "S of criterion {name} is {found} by {columns}, expected {b} by {b} as M is"
            )));
        }
        let s = DMatrix::from_fn(b, b, |i, j| 0.5 * (rows[i][j] + rows[j][i]));
        if value.is_finite() && s.iter().any(|entry| !entry.is_finite()) {
            return Err(unexpected(format!("S of criterion {name} is not finite where its value is {value}")));
        }
        Ok((value, s))
    }
}

impl Criterion for PythonCriterion {
    fn name(&self) -> &str {
        &self.0.name
    }

    fn evaluate(&self, m: &DMatrix<f64>, sensitivity: Option<&mut DMatrix<f64>>) -> Score {
        let is_asked = !self.has_raised() && m.clone().cholesky().is_some();
        let answer = if is_asked {
            Python::attach(|py| self.call(py, m)).map_err(|raised| self.0.keep(raised)).ok()
        } else {
            None
        };
        let answer = answer.filter(|(value, _)| value.is_finite());
        if let Some(into) = sensitivity {
            match &answer {
                Some((_, s)) => into.copy_from(s),
                None => into.fill(0.0),
            }
        }
        Score::exact(answer.map_or(f64::INFINITY, |(value, _)| value))
    }

    fn report(&self, value: f64) -> f64 {
        value
    }

    fn is_weighted(&self) -> bool {
        true
    }
}
