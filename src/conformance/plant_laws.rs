//! What every plant obeys, with any engine.
//!
//! - a reset state is the state; equal torques from equal states give equal bits after any history;
//! - at rest under the torque that Newton–Euler asks for, an arm stays at rest;
//! - velocity grows at the rate that the core's forward dynamics give, position at the rate of the velocity;
//! - one step and two of half its length arrive at the same state, as far as the engine's order allows;
//! - without friction the energy changes by the work of the torques;
//! - a torque that is not a number ends in an error, not in a panic.

use super::law_error::LawError;
use crate::dynamics::Dynamics;
use crate::experiment::Plant;
use crate::model::term::Dissipation;
use crate::model::{Robot, StandardParameters};
use crate::seed::Seed;

use rand::RngExt;

/// How exact an engine claims to be. Differences are the largest over joints, in rad and rad/s (m and m/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantTolerance {
    /// State after a reset against the state asked for.
    pub reset: f64,
    /// Velocity at rest after 0.2 s, rad/s.
    pub rest: f64,
    /// Rate of the first 10 µs against the core's acceleration, relative to the largest acceleration.
    pub acceleration: f64,
    /// State after 0.05 s in steps of 1 ms against steps of 0.5 ms.
    pub splitting: f64,
    /// Energy against work over 0.1 s, relative to the energy that was moved.
    pub energy: f64,
}

impl PlantTolerance {
    /// A method of order 4 on the core's own equations. At rest rounding grows with the arm's unstable modes; 10 µs at
    /// a jerk of some hundred rad/s³ change an acceleration by 1e-3 of itself; splitting leaves `h⁵` of order 1e-15 a
    /// step times the stiffness of friction.
    pub const FOURTH_ORDER: Self = Self { reset: 0.0, rest: 1e-9, acceleration: 1e-2, splitting: 1e-6, energy: 1e-7 };
    /// A method of order 1: every millisecond costs `h²/2` of an acceleration.
    pub const FIRST_ORDER: Self = Self { reset: 1e-9, rest: 1e-3, acceleration: 5e-2, splitting: 5e-2, energy: 5e-2 };
}

/// Checks one plant, which `make` builds anew each time from this robot and these parameters.
///
/// ```text
/// plant_laws::check(&robot, &parameters, &PlantTolerance::FOURTH_ORDER, |r, p| MyPlant::new(r, p))?
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check<P: Plant>(
    robot: &Robot,
    parameters: &StandardParameters,
    tolerance: &PlantTolerance,
    make: impl Fn(&Robot, &StandardParameters) -> P,
) -> Result<(), LawError> {
    let case = Case { robot, parameters, tolerance, make: &make };
    case.reset()?;
    case.determinism()?;
    case.rest()?;
    case.acceleration()?;
    case.splitting()?;
    case.energy()?;
    case.not_a_number()
}

struct Case<'a, F> {
    robot: &'a Robot,
    parameters: &'a StandardParameters,
    tolerance: &'a PlantTolerance,
    make: &'a F,
}

/// A state, and torques that accelerate it by up to 3 rad/s²: speeds up to a quarter of the limits.
fn draw(robot: &Robot, parameters: &StandardParameters, run: u64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut rng = Seed::new(0).stream("plant laws", run);
    let (mut q, mut qd, mut qdd) = (Vec::new(), Vec::new(), Vec::new());
    for joint in robot.joints() {
        let (low, high) = joint.limits.position;
        let (low, high) = if (high - low).is_finite() { (low, high) } else { (-1.0, 1.0) };
        q.push(low + (high - low) * rng.random_range(0.2..0.8));
        let speed = if joint.limits.velocity.is_finite() { joint.limits.velocity } else { 2.0 };
        qd.push(0.25 * speed * rng.random_range(-1.0..1.0));
        qdd.push(rng.random_range(-3.0..3.0));
    }
    let mut tau = vec![0.0; q.len()];
    Dynamics::new(robot, parameters).inverse(&q, &qd, &qdd, &mut tau);
    (q, qd, tau)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    // NaN must not be lost on the way.
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, |most, d| if d <= most { most } else { d })
}

impl<P: Plant, F: Fn(&Robot, &StandardParameters) -> P> Case<'_, F> {
    fn plant(&self) -> P {
        (self.make)(self.robot, self.parameters)
    }

    /// Steps and gives the state; a plant that fails here breaks the law at hand.
    fn run(
        &self,
        law: &'static str,
        plant: &mut P,
        tau: &[f64],
        dt: f64,
        steps: usize,
    ) -> Result<(Vec<f64>, Vec<f64>), LawError> {
        for _ in 0..steps {
            plant.step(tau, dt).map_err(|fault| LawError::failed(law, &fault, "a plant that goes on"))?;
        }
        let (q, qd) = plant.state();
        Ok((q.to_vec(), qd.to_vec()))
    }

    fn reset(&self) -> Result<(), LawError> {
        let law = "a reset state is the state";
        let n = self.robot.dof();
        let mut plant = self.plant();
        LawError::unless(law, plant.dof() == n, plant.dof().to_string(), format!("{n} joints"))?;
        for run in 0..5 {
            let (q, qd, _) = draw(self.robot, self.parameters, run);
            plant.reset(&q, &qd);
            let (own_q, own_qd) = plant.state();
            LawError::unless(law, own_q.len() == n && own_qd.len() == n, own_q.len().to_string(), n.to_string())?;
            let error = distance(&q, own_q).max(distance(&qd, own_qd));
            LawError::unless_at_most(law, error, self.tolerance.reset)?;
        }
        Ok(())
    }

    fn determinism(&self) -> Result<(), LawError> {
        let law = "equal states and torques give equal bits after any history";
        let mut plant = self.plant();
        for run in 0..3 {
            let (q, qd, tau) = draw(self.robot, self.parameters, run);
            plant.reset(&q, &qd);
            let first = self.run(law, &mut plant, &tau, 1e-3, 40)?;
            let mut fresh = self.plant();
            fresh.reset(&q, &qd);
            let second = self.run(law, &mut fresh, &tau, 1e-3, 40)?;
            let same = first
                .0
                .iter()
                .chain(&first.1)
                .zip(second.0.iter().chain(&second.1))
                .all(|(a, b)| a.to_bits() == b.to_bits());
            LawError::unless(law, same, format!("{first:?}"), format!("{second:?}"))?;
        }
        Ok(())
    }

    fn rest(&self) -> Result<(), LawError> {
        let law = "under the torque that holds it an arm stays at rest";
        let mut plant = self.plant();
        let mut dynamics = Dynamics::new(self.robot, self.parameters);
        for run in 0..5 {
            let (q, _, mut tau) = draw(self.robot, self.parameters, run);
            let zero = vec![0.0; q.len()];
            dynamics.inverse(&q, &zero, &zero, &mut tau);
            plant.reset(&q, &zero);
            let (_, qd) = self.run(law, &mut plant, &tau, 1e-3, 200)?;
            LawError::unless_at_most(law, distance(&qd, &zero), self.tolerance.rest)?;
        }
        Ok(())
    }

    fn acceleration(&self) -> Result<(), LawError> {
        let law = "velocity grows as forward dynamics say, position as the velocity says";
        let dt = 1e-5;
        let mut plant = self.plant();
        let mut dynamics = Dynamics::new(self.robot, self.parameters);
        for run in 0..10 {
            let (q, qd, tau) = draw(self.robot, self.parameters, run);
            let mut qdd = vec![0.0; q.len()];
            dynamics.forward(&q, &qd, &tau, &mut qdd);
            plant.reset(&q, &qd);
            let (q_end, qd_end) = self.run(law, &mut plant, &tau, dt, 1)?;
            let size = qdd.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            let rate: Vec<f64> = qd_end.iter().zip(&qd).map(|(b, a)| (b - a) / dt).collect();
            LawError::unless_at_most(law, distance(&rate, &qdd) / size, self.tolerance.acceleration)?;
            let moved: Vec<f64> = q_end.iter().zip(&q).map(|(b, a)| (b - a) / dt).collect();
            // Half an acceleration or a whole one, as the engine's order has it, and the reset's own error.
            let allowed = 1.5 * size * dt + 2.0 * self.tolerance.reset / dt + 1e-10;
            LawError::unless_at_most(law, distance(&moved, &qd), allowed)?;
        }
        Ok(())
    }

    fn splitting(&self) -> Result<(), LawError> {
        let law = "one step and two of half its length arrive at the same state";
        let mut plant = self.plant();
        for run in 0..5 {
            let (q, qd, tau) = draw(self.robot, self.parameters, run);
            plant.reset(&q, &qd);
            let whole = self.run(law, &mut plant, &tau, 1e-3, 50)?;
            plant.reset(&q, &qd);
            let halves = self.run(law, &mut plant, &tau, 5e-4, 100)?;
            let error = distance(&whole.0, &halves.0).max(distance(&whole.1, &halves.1));
            LawError::unless_at_most(law, error, self.tolerance.splitting)?;
        }
        Ok(())
    }

    fn energy(&self) -> Result<(), LawError> {
        let law = "without friction the energy changes by the work of the torques";
        let mut parameters = self.parameters.clone();
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| term.entry().dissipation == Dissipation::Stores);
        }
        let dynamics = Dynamics::new(self.robot, &parameters);
        let mut plant = (self.make)(self.robot, &parameters);
        for run in 0..5 {
            let (q, qd, tau) = draw(self.robot, &parameters, run);
            plant.reset(&q, &qd);
            let before = dynamics.energy(&q, &qd);
            let (q_end, qd_end) = self.run(law, &mut plant, &tau, 1e-3, 100)?;
            let after = dynamics.energy(&q_end, &qd_end);
            // The torque is constant: its work is the torque times the displacement.
            let work: f64 = (0..q.len()).map(|i| tau[i] * (q_end[i] - q[i])).sum();
            let moved = before.kinetic + after.kinetic + work.abs() + (after.potential - before.potential).abs();
            let error = (after.total() - before.total() - work).abs() / moved;
            LawError::unless_at_most(law, error, self.tolerance.energy)?;
        }
        Ok(())
    }

    fn not_a_number(&self) -> Result<(), LawError> {
        let law = "a torque that is not a number ends in an error";
        let (q, qd, mut tau) = draw(self.robot, self.parameters, 0);
        let mut plant = self.plant();
        plant.reset(&q, &qd);
        tau[0] = f64::NAN;
        let ended = (0..3).any(|_| plant.step(&tau, 1e-3).is_err());
        LawError::unless(law, ended, "three steps without one", "an error")?;
        // And a reset makes it good again.
        plant.reset(&q, &qd);
        tau[0] = 0.0;
        self.run(law, &mut plant, &tau, 1e-3, 1).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::PlantError;
    use crate::experiment::hinges::{self, FlyWheels};

    /// Flywheels with a flaw.
    struct Flawed(FlyWheels, Flaw);

    #[derive(Clone, Copy, Debug)]
    enum Flaw {
        None,
        DropsVelocity,
        KeepsHistory,
        Heavy,
        Drifts,
    }

    impl Plant for Flawed {
        fn dof(&self) -> usize {
            self.0.dof()
        }

        fn state(&self) -> (&[f64], &[f64]) {
            self.0.state()
        }

        fn reset(&mut self, q: &[f64], qd: &[f64]) {
            match self.1 {
                Flaw::DropsVelocity => self.0.reset(q, &vec![0.0; qd.len()]),
                Flaw::KeepsHistory => {
                    let old = self.0.state().0[0];
                    let mut q = q.to_vec();
                    q[0] += 1e-18 + 1e-12 * old;
                    self.0.reset(&q, qd);
                }
                _ => self.0.reset(q, qd),
            }
        }

        fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
            let tau: Vec<f64> = match self.1 {
                Flaw::Heavy => tau.iter().map(|t| 0.9 * t).collect(),
                Flaw::Drifts => tau.iter().map(|t| t + 0.01).collect(),
                _ => tau.to_vec(),
            };
            self.0.step(&tau, dt)
        }
    }

    #[test]
    fn flywheels_obey_and_each_flaw_breaks_its_law() {
        let robot = hinges::single();
        let judge = |flaw, tolerance: &PlantTolerance| {
            check(&robot, &hinges::parameters(1), tolerance, |robot, _| Flawed(FlyWheels::new(robot.dof()), flaw))
        };
        let exact = PlantTolerance::FOURTH_ORDER;
        assert_eq!(judge(Flaw::None, &exact), Ok(()));
        let lax = PlantTolerance { reset: 1e-9, ..exact };
        for (flaw, tolerance, law) in [
            (Flaw::DropsVelocity, exact, "a reset state is the state"),
            (Flaw::KeepsHistory, lax, "equal states and torques give equal bits after any history"),
            (Flaw::Heavy, exact, "velocity grows as forward dynamics say, position as the velocity says"),
            (Flaw::Drifts, exact, "under the torque that holds it an arm stays at rest"),
        ] {
            let broken = judge(flaw, &tolerance).unwrap_err();
            assert_eq!(broken.law, law, "{flaw:?}: {broken}");
        }
    }
}
