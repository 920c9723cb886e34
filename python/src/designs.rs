//! Designs of trajectories.

use std::ops::ControlFlow;

use armid::excitation::{CriterionKind, LimitSettings};
use armid::trajectory::Family;
use armid_io::Error;
use armid_workflow::design::{DesignGoal, DesignSettings, HeaviestLoad, design as designed};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::callable::Method;
use crate::criterion::PythonCriterion;
use crate::fault::{exception, unexpected};
use crate::robot::Robot;
use crate::simulation::{Motion, effects};
use crate::watch::{Leaves, watched};

/// What a design is asked for: a mapping with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    criterion: Option<Method>,
    /// Mass, kg, and centre, m.
    payload: Option<(f64, [f64; 3])>,
    columns: String,
    period_s: f64,
    family: String,
    harmonics: Vec<usize>,
    frozen: Vec<(String, f64)>,
    seed: u64,
    starts: u64,
    from: Vec<String>,
    evaluations: Option<usize>,
    iterations: Option<usize>,
    margin_deg: f64,
    confidence: Option<f64>,
    ramp_s: Option<f64>,
    clearance_m: Option<f64>,
    keep_above_m: Option<f64>,
    max_acceleration: Option<f64>,
    weighted: bool,
    prior: Vec<std::path::PathBuf>,
    effects: String,
    predict: Vec<String>,
    periods: usize,
    baseline: bool,
}

impl Asked {
    /// What it is made for, and the criterion where that is of Python.
    fn goal(&mut self) -> PyResult<(DesignGoal, Option<PythonCriterion>)> {
        match (self.criterion.take(), self.payload) {
            (Some(Method::Own(name, function)), None) => {
                let own = PythonCriterion::new(name, function);
                Ok((DesignGoal::Arm(own.shared()), Some(own)))
            }
            (Some(Method::Listed(name)), None) => {
                let names = || CriterionKind::ALL.map(CriterionKind::name).join(", ");
                CriterionKind::parse(&name).map(|kind| (DesignGoal::Arm(kind.into()), None)).ok_or_else(|| {
                    unexpected(format!("criterion is \"{name}\", expected a callable, or one of {}", names()))
                })
            }
            (None, Some((mass_kg, centre_m))) => Ok((DesignGoal::Load(HeaviestLoad { mass_kg, centre_m }), None)),
            _ => Err(unexpected("expected either criterion= or payload=")),
        }
    }

    fn settings(mut self, robot: &Robot) -> PyResult<(DesignSettings, Option<PythonCriterion>)> {
        let names = || Family::ALL.map(Family::name).join(", ");
        let family = Family::parse(&self.family)
            .ok_or_else(|| unexpected(format!("family is \"{}\", expected one of {}", self.family, names())))?;
        let (goal, own) = self.goal()?;
        let usual = DesignSettings::new(goal);
        let limits = LimitSettings {
            margin_deg: self.margin_deg,
            confidence: self.confidence,
            ramp_s: self.ramp_s,
            clearance_m: self.clearance_m,
        };
        let settings = DesignSettings {
            columns: robot.columns(&self.columns)?,
            period_s: self.period_s,
            family,
            harmonics: self.harmonics,
            frozen: self.frozen,
            seed: self.seed,
            starts: self.starts,
            from: self.from,
            evaluations: self.evaluations.unwrap_or(usual.evaluations),
            iterations: self.iterations,
            limits,
            max_acceleration: self.max_acceleration,
            keep_above_m: self.keep_above_m,
            weighted: self.weighted,
            prior: self.prior,
            expected: effects(&self.effects)?,
            predict: self.predict,
            periods: self.periods,
            baseline: self.baseline,
            ..usual
        };
        Ok((settings, own))
    }
}

/// The trajectory's file, and the answer of the command.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    robot: &Robot,
    asked: Asked,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String)> {
    let (settings, own) = asked.settings(robot)?;
    let (loaded, criterion) = (robot.loaded.clone(), own.clone());
    let answer = watched(py, progress, Leaves::Nothing, move |observer| {
        let ended = |progress| match &criterion {
            Some(own) if own.has_raised() => ControlFlow::Break(()),
            _ => observer.observe(progress),
        };
        let answer = designed(&loaded, &settings, &ended)?;
        let answer = answer.ok_or_else(|| Error::new("the search was ended before its first design"))?;
        Ok((answer.toml(), serde_json::to_string(&answer).map_err(Error::new)?))
    })?;
    match own.and_then(|own| own.raised()) {
        Some(raised) => Err(raised),
        None => answer.map_err(exception),
    }
}

/// Samples of a motion, N × n.
type Table<'py> = Bound<'py, PyArray2<f64>>;

/// Time, s, N, and position, velocity and acceleration over one period.
#[pyfunction]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    robot: &Robot,
    motion: Motion,
    rate_hz: f64,
) -> PyResult<(Bound<'py, PyArray1<f64>>, [Table<'py>; 3])> {
    let trajectory = motion.read(robot).map_err(exception)?;
    let count = rate_hz * trajectory.period_s();
    if !(rate_hz > 0.0 && (1.0..=MOST_SAMPLES).contains(&count) && (count - count.round()).abs() <= 1e-9 * count) {
        let period = trajectory.period_s();
        let message = format!(
            "a rate of {rate_hz} Hz gives {count} samples of a period of {period} s, expected a whole number from 1 to \
             {MOST_SAMPLES}"
        );
        return Err(unexpected(message));
    }
    let (count, n) = (count.round() as usize, robot.dof());
    let states = py.detach(|| trajectory.sample(count));
    let table = |values: Vec<f64>| PyArray1::from_vec(py, values).reshape([count, n]);
    let t = PyArray1::from_iter(py, (0..count).map(|k| k as f64 / rate_hz));
    Ok((t, [table(states.q)?, table(states.qd)?, table(states.qdd)?]))
}

/// Samples that one call makes at most.
const MOST_SAMPLES: f64 = 1e7;
