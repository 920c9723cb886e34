//! Monte Carlo studies.

use std::path::PathBuf;

use armid_io::Error;
use armid_io::study::load_plans;
use armid_sim::Engine;
use armid_workflow::study::{StudySettings, perform};
use pyo3::prelude::*;

use crate::fault::exception;
use crate::watch::{Leaves, watched};

/// Performs a study into a folder; the answer is that of the library.
#[pyfunction]
pub(crate) fn study(
    py: Python<'_>,
    plan: String,
    output: PathBuf,
    resume: bool,
    threads: usize,
    until: Option<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let answer = watched(py, progress, Leaves::Files, move |observer| {
        let (plans, beside) = load_plans(&plan, &Engine::ALL.map(Engine::name))?;
        let settings = StudySettings { output, beside, threads, resume, until, ..StudySettings::default() };
        serde_json::to_string(&perform(&plans, &settings, observer)?).map_err(Error::of)
    })?;
    answer.map_err(exception)
}
