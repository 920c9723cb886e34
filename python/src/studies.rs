//! Monte Carlo studies.

use std::ops::ControlFlow;
use std::path::PathBuf;

use armid::study::OwnMethods;
use armid_io::Error;
use armid_io::study::load_plans;
use armid_sim::Engine;
use armid_workflow::study::{StudySettings, perform};
use pyo3::prelude::*;

use crate::criterion::PythonCriterion;
use crate::estimator::PythonEstimator;
use crate::fault::exception;
use crate::watch::{Leaves, watched};

/// Performs a study into a folder; the answer is that of the library, and what an estimator raised first: its run is a row without
/// an estimate. What a criterion raises ends the study. The plan may name the estimators and criteria that are given.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "one for each keyword of the call")]
pub(crate) fn study(
    py: Python<'_>,
    plan: String,
    output: PathBuf,
    resume: bool,
    threads: usize,
    until: Option<String>,
    estimators: Vec<(String, Py<PyAny>)>,
    criteria: Vec<(String, Py<PyAny>)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Option<String>)> {
    let estimators: Vec<_> = estimators.into_iter().map(|(name, of)| PythonEstimator::new(name, of)).collect();
    let criteria: Vec<_> = criteria.into_iter().map(|(name, of)| PythonCriterion::new(name, of)).collect();
    let own = OwnMethods {
        estimators: estimators.iter().map(PythonEstimator::shared).collect(),
        criteria: criteria.iter().map(PythonCriterion::shared).collect(),
    };
    let searching = criteria.clone();
    let answer = watched(py, progress, Leaves::Files, move |observer| {
        let (plans, beside) = load_plans(&plan, &Engine::ALL.map(Engine::name), &own)?;
        let settings = StudySettings { output, beside, threads, resume, until, own, ..StudySettings::default() };
        let ended = |progress| {
            let has_raised = searching.iter().any(PythonCriterion::has_raised);
            if has_raised { ControlFlow::Break(()) } else { observer.observe(progress) }
        };
        serde_json::to_string(&perform(&plans, &settings, &ended)?).map_err(Error::new)
    })?;
    if let Some(raised) = criteria.iter().find_map(PythonCriterion::raised) {
        return Err(raised);
    }
    Ok((
        answer.map_err(exception)?,
        estimators.iter().find_map(PythonEstimator::raised).map(|raised| raised.to_string()),
    ))
}
