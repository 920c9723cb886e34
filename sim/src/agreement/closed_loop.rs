//! The same experiment on each engine, under the same servo.

use armid::experiment::{Discarding, Ending, ExperimentPlan, Phase, Sensing, Servo};

use super::case::Case;
use crate::Engine;
use crate::engine::EngineError;

/// True positions and efforts of the recorded period, one row of n per sample.
#[derive(Debug)]
pub(super) struct Performed {
    pub(super) q: Vec<Vec<f64>>,
    pub(super) tau: Vec<Vec<f64>>,
}

/// One period of the experiment with sensors that read exactly what is there, so that no rounding to counts hides or
/// enlarges a difference.
pub(super) fn perform(engine: Engine, case: &Case<'_>) -> Result<Performed, EngineError> {
    let fault = |reason: String| EngineError { engine, reason };
    let plan = ExperimentPlan::clone(case.plan).with_periods(1);
    let plant = engine.plant(case.robot, case.truth)?;
    let servo = Servo::new(case.robot, case.nominal, plant).map_err(|error| fault(error.to_string()))?;
    let (mut q, mut tau) = (Vec::new(), Vec::new());
    let ending = servo
        .with_sensing(Sensing::ideal())
        .perform_observed(&plan, &mut Discarding, &mut |state| {
            if state.phase == Phase::Record {
                q.push(state.q.to_vec());
                tau.push(state.tau.to_vec());
            }
        })
        .map_err(|error| fault(error.to_string()))?;
    match ending {
        Ending::Diverged { t, reason, .. } => Err(fault(format!("the motion diverged at t = {t:.3} s: {reason}"))),
        _ => Ok(Performed { q, tau }),
    }
}
