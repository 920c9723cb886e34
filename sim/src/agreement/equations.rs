//! The engine's equations of motion against the core's Newton–Euler, as torques.

use armid::dynamics::Dynamics;
use armid::model::{Robot, StandardParameters};
use armid::seed::Seed;
use rand::RngExt;

use super::free_motion::draw_state;
use crate::Engine;
use crate::engine::EngineError;

/// How many states are looked at.
const STATES: u64 = 20;

/// Largest torque residual over random states, relative to the largest torque there.
pub(super) fn residual(
    engine: Engine,
    robot: &Robot,
    parameters: &StandardParameters,
    seed: Seed,
) -> Result<f64, EngineError> {
    let mut dynamics = Dynamics::new(robot, parameters);
    let mut most: f64 = 0.0;
    for run in 0..STATES {
        let mut rng = seed.stream("agreement equations", run);
        let (q, qd) = draw_state(robot, &mut rng);
        let qdd: Vec<f64> = q.iter().map(|_| rng.random_range(-5.0..5.0)).collect();
        let mut tau = vec![0.0; q.len()];
        dynamics.inverse(&q, &qd, &qdd, &mut tau);
        let size = tau.iter().fold(f64::MIN_POSITIVE, |size, tau| size.max(tau.abs()));
        for residual in engine.torque_residual(robot, parameters, &q, &qd, &qdd, &tau)? {
            // NaN must not be lost on the way.
            let ratio = residual.abs() / size;
            most = if ratio <= most { most } else { ratio };
        }
    }
    Ok(most)
}
