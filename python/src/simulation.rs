//! Experiments on simulated arms.

use armid::experiment::{Effects, Ending, ExperimentPlan, Sensing};
use armid::trajectory::PeriodicTrajectory;
use armid_io::{Error, Text, trajectory};
use armid_sim::Engine;
use armid_workflow::{SimulationSettings, simulate as simulated};
use pyo3::prelude::*;

use crate::fault::{exception, unexpected};
use crate::log::Log;
use crate::robot::Robot;
use crate::watch::{Leaves, watched};

/// A trajectory: a name or a path, or the text of its file.
#[derive(FromPyObject)]
pub(crate) struct Motion {
    #[pyo3(item)]
    name: String,
    #[pyo3(item)]
    text: Option<String>,
}

impl Motion {
    pub(crate) fn read(&self, robot: &Robot) -> Result<PeriodicTrajectory, Error> {
        match &self.text {
            Some(text) => trajectory::parse(&Text::new(&self.name, text.as_str()), &robot.loaded.robot),
            None => trajectory::load(&self.name, None, &robot.loaded.robot),
        }
    }
}

/// Effects by their names, from JSON.
pub(crate) fn effects(text: &str) -> PyResult<Effects> {
    serde_json::from_str(text).map_err(|fault| {
        let said = fault.to_string();
        unexpected(format!("effects: {}", said.split(" at line ").next().unwrap_or(&said)))
    })
}

/// How it is simulated: a mapping with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Experiment {
    engine: String,
    effects: String,
    seed: u64,
    run: u64,
    rate_hz: f64,
    settle_s: f64,
    ramp_s: f64,
    discarded_periods: usize,
    periods: usize,
    noise: bool,
}

/// The recording of an experiment, and how it ended where that was early.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    robot: &Robot,
    motion: Motion,
    experiment: Experiment,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Log, Option<String>)> {
    let names = Engine::ALL.map(Engine::name).join(", ");
    let engine = Engine::parse(&experiment.engine)
        .ok_or_else(|| unexpected(format!("engine is \"{}\", expected one of {names}", experiment.engine)))?;
    let plan = ExperimentPlan {
        trajectory: motion.read(robot).map_err(exception)?,
        rate_hz: experiment.rate_hz,
        settle_s: experiment.settle_s,
        ramp_s: experiment.ramp_s,
        discarded_periods: experiment.discarded_periods,
        periods: experiment.periods,
    };
    let settings = SimulationSettings {
        engine,
        effects: effects(&experiment.effects)?,
        sensing: if experiment.noise { Sensing::default() } else { Sensing::ideal() },
        seed: experiment.seed,
        run: experiment.run,
    };
    let loaded = robot.loaded.clone();
    let done = watched(py, progress, Leaves::Nothing, move |observer| simulated(&loaded, &plan, &settings, observer))?;
    let done = done.map_err(exception)?;
    let ending = match &done.ending {
        Ending::Diverged { t, reason, .. } => Some(format!("the motion diverged at {t:.3} s: {reason}")),
        Ending::Stopped { t, .. } | Ending::Tripped { t, .. } => Some(format!("the experiment ended at {t:.3} s")),
        Ending::Completed => None,
    };
    Ok((Log::of(done.log()), ending))
}
