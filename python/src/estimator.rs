//! An estimator that is written in Python.

use std::sync::Arc;

use armid::estimation::{Estimate, EstimationError, EstimationProblem, Estimator, EstimatorKind, Observation};
use nalgebra::{DMatrix, DVector};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::callable::{Callable, numbers};

/// β, and its covariance row by row where there is one.
type Answer = (Vec<f64>, Option<Vec<Vec<f64>>>);

/// W, m × b, and y, m.
type Equations<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// A callable `(W, y) → β`, or `→ (β, C)` with the covariance of β.
#[derive(Clone, Debug)]
pub(crate) struct PythonEstimator(Arc<Callable>);

impl PythonEstimator {
    pub(crate) fn new(name: String, function: Py<PyAny>) -> Self {
        Self(Arc::new(Callable::new(name, function)))
    }

    /// As one of several estimators.
    pub(crate) fn shared(&self) -> Arc<dyn Estimator> {
        Arc::new(self.clone())
    }

    /// The exception that it raised.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.0.raised()
    }

    /// β and, where it gives one, C.
    fn call(&self, py: Python<'_>, observation: &Observation) -> PyResult<Answer> {
        let (w, y) = equations(py, observation)?;
        let answer = self.0.function.bind(py).call1((w, y))?;
        if let Ok(pair) = answer.cast::<PyTuple>()
            && pair.len() == 2
        {
            let [beta, covariance] = [pair.get_item(0)?, pair.get_item(1)?];
            return Ok((numbers(&beta)?.extract()?, Some(numbers(&covariance)?.extract()?)));
        }
        Ok((numbers(&answer)?.extract()?, None))
    }
}

/// The equations: W, m × b, and y, m, without the rows that are none.
fn equations<'py>(py: Python<'py>, observation: &Observation) -> PyResult<Equations<'py>> {
    let rows: Vec<usize> = (0..observation.y.len()).filter(|&row| observation.used[row]).collect();
    let (w, b) = (&observation.regressor, observation.regressor.ncols());
    let entries = rows.iter().flat_map(|&row| (0..b).map(move |c| w[(row, c)]));
    let w = PyArray1::from_iter(py, entries).reshape([rows.len(), b])?;
    Ok((w, PyArray1::from_iter(py, rows.iter().map(|&row| observation.y[row]))))
}

impl Estimator for PythonEstimator {
    fn name(&self) -> &str {
        &self.0.name
    }

    fn summary(&self) -> &'static str {
        "a callable of Python"
    }

    fn estimate(&self, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
        let (beta, covariance) = Python::attach(|py| self.call(py, problem.observation)).map_err(|raised| {
            let said = raised.to_string();
            self.0.keep(raised);
            EstimationError::external(said)
        })?;
        let ordinary = EstimatorKind::Ols.estimator().estimate(problem)?;
        let covariance = match covariance {
            Some(rows) => {
                let columns = rows.first().map_or(0, Vec::len);
                if let Some(row) = rows.iter().find(|row| row.len() != columns) {
                    let (quantity, found) = ("columns of the covariance", row.len());
                    return Err(EstimationError::Count { quantity, found, expected: columns });
                }
                DMatrix::from_row_iterator(rows.len(), columns, rows.into_iter().flatten())
            }
            // Of equal noise in every equation, as the callable sees them.
            None => ordinary.covariance_matrix(),
        };
        Estimate::of(self.name(), problem, &DVector::from_vec(beta), &covariance, ordinary.degrees_of_freedom)
    }
}
