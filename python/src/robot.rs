//! A robot that was loaded.

use std::sync::Arc;

use armid::model::Columns;
use armid::model::format::ChainEnds;
use armid::provenance::sha256;
use armid_io::inputs::RobotSource;
use armid_io::{LoadedRobot, robot};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::fault::{exception, unexpected};

/// A robot, and what it was called.
#[pyclass(frozen, module = "armid._armid")]
#[derive(Clone)]
pub(crate) struct Robot {
    pub(crate) loaded: Arc<LoadedRobot>,
    /// What estimates remember of it.
    pub(crate) source: RobotSource,
}

impl Robot {
    pub(crate) fn new(loaded: LoadedRobot, name: Option<String>, ends: ChainEnds) -> Self {
        let sha256 = sha256(&loaded.text.content);
        let source = RobotSource { name, sha256, base_link: ends.base, tip_link: ends.tip };
        Self { loaded: Arc::new(loaded), source }
    }

    pub(crate) fn dof(&self) -> usize {
        self.loaded.robot.dof()
    }

    /// The parameters of a model that this robot can be estimated with.
    pub(crate) fn columns(&self, text: &str) -> PyResult<Columns> {
        Columns::parse_estimable(text).map_err(unexpected)
    }
}

#[pymethods]
impl Robot {
    #[staticmethod]
    #[pyo3(signature = (name, base_link=None, tip_link=None))]
    fn load(py: Python<'_>, name: String, base_link: Option<String>, tip_link: Option<String>) -> PyResult<Self> {
        let ends = ChainEnds { base: base_link, tip: tip_link };
        let loaded = py.detach(|| robot::load(&name, &ends, None)).map_err(exception)?;
        Ok(Self::new(loaded, Some(name), ends))
    }

    #[getter]
    fn name(&self) -> &str {
        self.loaded.robot.name()
    }

    #[getter]
    fn joints(&self) -> Vec<String> {
        self.loaded.robot.joints().iter().map(|joint| joint.name.clone()).collect()
    }

    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.loaded.remarks.clone()
    }

    /// What it was called, and the links of its chain; no name where a recording held it.
    #[getter]
    fn source(&self) -> (Option<String>, Option<String>, Option<String>) {
        let RobotSource { name, base_link, tip_link, .. } = self.source.clone();
        (name, base_link, tip_link)
    }

    /// Names and units of the parameters of these columns.
    fn parameters(&self, columns: &str) -> PyResult<Vec<(String, String)>> {
        let robot = &self.loaded.robot;
        let ids = self.columns(columns)?.parameters(robot);
        Ok(ids.into_iter().map(|id| (id.to_string(), id.kind.unit(robot.joints()[id.index].kind).to_owned())).collect())
    }

    /// What is known of the parameters without an experiment.
    fn nominal<'py>(&self, py: Python<'py>, columns: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (robot, columns) = (&self.loaded.robot, self.columns(columns)?);
        let guess = self.loaded.guess().ok_or_else(|| self.without_parameters())?;
        Ok(PyArray1::from_slice(py, guess.vector(robot, columns).as_slice()))
    }
}

impl Robot {
    pub(crate) fn without_parameters(&self) -> PyErr {
        unexpected(format!(
            "robot \"{}\" has no nominal parameters, expected parameters=: one number for each column",
            self.loaded.robot.name()
        ))
    }
}
