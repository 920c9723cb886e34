//! Motion without torque and friction, in steps that are halved.

use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::model::{Robot, StandardParameters};
use armid::seed::Seed;
use rand::{Rng, RngExt};

use super::reference;
use crate::Engine;
use crate::engine::EngineError;

/// Interval between the instants at which positions are compared, s: the coarsest step.
const INTERVAL: f64 = 1.0 / 64.0;
/// How many intervals: 0.25 s.
const POINTS: usize = 16;
/// The finest step halves the interval this often.
const HALVINGS: u32 = 6;
/// The certificate's own step, 2⁻¹⁰ s, a servo step: the interval halved this often.
pub(super) const CERTIFIED: u32 = 4;
/// Steps of the reference in an interval.
const REFERENCE_STEPS: usize = 128;
/// States from which motion starts.
const STARTS: u64 = 3;

/// The largest error of one engine at one step.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StepError {
    /// The step, s.
    pub step_s: f64,
    /// Largest distance of a joint from the reference, over joints, instants and starts, rad (m).
    pub error: f64,
}

/// A state within the middle six tenths of each joint's range, at up to a quarter of its speed limit; n each.
pub(super) fn draw_state(robot: &Robot, rng: &mut impl Rng) -> (Vec<f64>, Vec<f64>) {
    robot
        .joints()
        .iter()
        .map(|joint| {
            let (low, high) = joint.limits.position;
            let (low, high) = if (high - low).is_finite() { (low, high) } else { (-1.0, 1.0) };
            let speed = if joint.limits.velocity.is_finite() { joint.limits.velocity } else { 2.0 };
            (low + (high - low) * rng.random_range(0.2..0.8), 0.25 * speed * rng.random_range(-1.0..1.0))
        })
        .unzip()
}

/// Largest distance over instants and joints.
pub(super) fn distance(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    // NaN must not be lost on the way.
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, |most, d| if d <= most { most } else { d })
}

/// One start with its reference.
#[derive(Debug)]
struct Start {
    q: Vec<f64>,
    qd: Vec<f64>,
    reference: Vec<Vec<f64>>,
}

/// The motions that every engine is asked for.
#[derive(Debug)]
pub(super) struct FreeMotion<'a> {
    robot: &'a Robot,
    parameters: &'a StandardParameters,
    starts: Vec<Start>,
    /// Error of the reference itself, rad (m).
    pub(super) reference_error: f64,
    /// Largest travel of a joint, rad (m).
    pub(super) travel: f64,
}

/// What one engine made of them.
#[derive(Debug)]
pub(super) struct Followed {
    pub(super) errors: Vec<StepError>,
    /// Positions at the certified step, one list of instants per start.
    pub(super) positions: Vec<Vec<Vec<f64>>>,
    /// Largest change of energy at the certified step, relative to the energy that moved.
    pub(super) energy: f64,
}

impl<'a> FreeMotion<'a> {
    /// `parameters` without friction.
    pub(super) fn new(robot: &'a Robot, parameters: &'a StandardParameters, seed: Seed) -> Self {
        let (mut reference_error, mut travel): (f64, f64) = (0.0, 0.0);
        let starts = (0..STARTS)
            .map(|run| {
                let (q, qd) = draw_state(robot, &mut seed.stream("agreement starts", run));
                let [coarse, reference] = [REFERENCE_STEPS / 2, REFERENCE_STEPS]
                    .map(|steps| reference::trajectory(robot, parameters, &q, &qd, INTERVAL, POINTS, steps));
                reference_error = reference_error.max(distance(&coarse, &reference));
                travel = travel.max(distance(&vec![q.clone(); POINTS + 1], &reference));
                Start { q, qd, reference }
            })
            .collect();
        Self { robot, parameters, starts, reference_error, travel }
    }

    pub(super) const fn step_s(halvings: u32) -> f64 {
        INTERVAL / (1_u32 << halvings) as f64
    }

    pub(super) const fn horizon_s() -> f64 {
        INTERVAL * POINTS as f64
    }

    pub(super) fn follow(&self, engine: Engine) -> Result<Followed, EngineError> {
        let mut plant = engine.plant(self.robot, self.parameters)?;
        let mut followed = Followed { errors: Vec::new(), positions: Vec::new(), energy: 0.0 };
        let dynamics = Dynamics::new(self.robot, self.parameters);
        for halvings in 0..=HALVINGS {
            let mut error: f64 = 0.0;
            for start in &self.starts {
                let (positions, velocities) = self.run(engine, plant.as_mut(), start, halvings)?;
                let own = distance(&positions, &start.reference);
                error = if own <= error { error } else { own };
                if halvings == CERTIFIED {
                    let energies: Vec<_> =
                        positions.iter().zip(&velocities).map(|(q, qd)| dynamics.energy(q, qd)).collect();
                    let first = energies[0];
                    let moved = energies
                        .iter()
                        .fold(first.kinetic, |most, e| most.max(e.kinetic).max((e.potential - first.potential).abs()));
                    let change = energies.iter().fold(0.0, |most: f64, e| most.max((e.total() - first.total()).abs()));
                    followed.energy = followed.energy.max(change / moved);
                    followed.positions.push(positions);
                }
            }
            followed.errors.push(StepError { step_s: Self::step_s(halvings), error });
        }
        Ok(followed)
    }

    /// Positions and velocities at the instants.
    #[expect(clippy::type_complexity, reason = "positions and velocities, one row per instant")]
    fn run(
        &self,
        engine: Engine,
        plant: &mut dyn Plant,
        start: &Start,
        halvings: u32,
    ) -> Result<(Vec<Vec<f64>>, Vec<Vec<f64>>), EngineError> {
        let still = vec![0.0; start.q.len()];
        let (mut positions, mut velocities) = (vec![start.q.clone()], vec![start.qd.clone()]);
        plant.reset(&start.q, &start.qd);
        for _ in 0..POINTS {
            for _ in 0..1_u32 << halvings {
                plant
                    .step(&still, Self::step_s(halvings))
                    .map_err(|fault| EngineError { engine, reason: fault.to_string() })?;
            }
            let (q, qd) = plant.state();
            positions.push(q.to_vec());
            velocities.push(qd.to_vec());
        }
        Ok((positions, velocities))
    }
}

/// Order of convergence: the slope of log error over log step through the three finest steps at which the error is
/// well above `floor`; `None` where there are not three.
pub(super) fn order(errors: &[StepError], floor: f64) -> Option<f64> {
    let usable: Vec<&StepError> = errors.iter().filter(|point| point.error > 30.0 * floor).collect();
    let last = usable.get(usable.len().checked_sub(3)?..)?;
    let points: Vec<(f64, f64)> = last.iter().map(|p| (libm::log2(p.step_s), libm::log2(p.error))).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / 3.0;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let across: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let along: f64 = points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    Some(across / along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_order_of_a_power_with_a_floor() {
        let errors: Vec<StepError> = (0..7)
            .map(|k| {
                let step_s = FreeMotion::step_s(k);
                StepError { step_s, error: (step_s * step_s * step_s).max(1e-7) }
            })
            .collect();
        // Steps of 1/64, 1/128, 1/256 stand above the floor: the cubes 3.8e-6, 4.8e-7, 6.0e-8 and then 1e-7.
        assert!((order(&errors, 1e-10).unwrap() - 3.0).abs() > 0.1);
        assert_eq!(order(&errors, 1e-7), None);
        let clean: Vec<StepError> = errors.iter().map(|e| StepError { error: e.step_s * e.step_s, ..*e }).collect();
        assert!((order(&clean, 1e-16).unwrap() - 2.0).abs() < 1e-12);
    }
}
