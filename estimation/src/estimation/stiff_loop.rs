//! A closed loop that needs no simulation: a servo so stiff that a drive's torque bends its motion by a little, and nothing else.
//!
//! ```text
//! q_s(φ) = q + κ (τ(φ*) − τ(φ))        q̇_s = q̇, q̈_s = q̈        τ(φ) = Y(q, q̇, q̈) φ
//! ```
//! about the motion that the arm with parameters φ* makes. Its derivatives by parameters are columns of the regressor: the
//! laws of estimators that simulate are checked on it, in closed form.

use nalgebra::DMatrix;

use super::closed_loop::{ClosedLoop, ClosedLoopError, ClosedLoopMotion, ClosedLoopSlopes};
use crate::dynamics::States;
use crate::model::{Columns, ParameterId, Robot, StandardParameters};
use crate::observer::Observer;
use crate::regressor::JointTorqueRegressor;

/// A servo that hardly lets its arm deviate from one motion.
#[derive(Clone, Debug)]
pub struct StiffLoop {
    nominal: StandardParameters,
    robot: Robot,
    columns: Columns,
    states: States,
    /// Torque on the motion itself, N × n.
    tau: Vec<f64>,
    compliance: f64,
}

impl StiffLoop {
    /// About the motion `states` of an arm with `parameters`, from which a joint deviates by `compliance` (rad per N·m). Search
    /// begins from `nominal`.
    pub fn new(
        robot: &Robot,
        columns: Columns,
        parameters: &StandardParameters,
        nominal: StandardParameters,
        states: States,
        compliance: f64,
    ) -> Self {
        let mut stiff = Self { nominal, robot: robot.clone(), columns, states, tau: Vec::new(), compliance };
        stiff.tau = stiff.torque(parameters);
        stiff
    }

    fn regressor(&self) -> JointTorqueRegressor {
        JointTorqueRegressor::new(&self.robot, self.columns).expect("columns of motion")
    }

    fn torque(&self, parameters: &StandardParameters) -> Vec<f64> {
        let phi = parameters.vector(&self.robot, self.columns);
        (self.regressor().stack(&self.states) * phi).as_slice().to_vec()
    }
}

impl ClosedLoop for StiffLoop {
    fn nominal(&self) -> &StandardParameters {
        &self.nominal
    }

    fn motion(&self, parameters: &StandardParameters, _: &dyn Observer) -> Result<ClosedLoopMotion, ClosedLoopError> {
        let tau = self.torque(parameters);
        let mut states = self.states.clone();
        for ((q, own), tau) in states.q.iter_mut().zip(&self.tau).zip(&tau) {
            *q += self.compliance * (own - tau);
        }
        Ok(ClosedLoopMotion { states, tau })
    }

    fn slopes(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        let regressor = self.regressor();
        let column = |id: &ParameterId| regressor.parameters().iter().position(|own| own == id);
        let columns: Option<Vec<usize>> = by.iter().map(column).collect();
        let columns = columns.ok_or_else(|| ClosedLoopError::Unsimulable {
            reason: format!("a parameter is not among those of columns {}", self.columns),
        })?;
        let tau: DMatrix<f64> = regressor.stack_means(&self.states, &columns, block);
        let q = &tau * -self.compliance;
        Ok((self.motion(parameters, observer)?, ClosedLoopSlopes { q, tau }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{random_robot, random_state};
    use crate::dynamics::Dynamics;
    use crate::observer::Unobserved;
    use crate::seed::Seed;

    #[test]
    fn identity_motion_follows_inverse_dynamics_and_slopes_are_its_differences() {
        let mut rng = Seed::new(5).stream("stiff", 0);
        let ((robot, own), (_, other)) = (random_robot(&mut rng, 2), random_robot(&mut rng, 2));
        let mut states = States::new(2);
        for _ in 0..4 {
            let (q, qd, qdd) = random_state(&mut rng, 2);
            states.push(&q, &qd, &qdd);
        }
        let torque = |parameters: &StandardParameters| {
            let (mut all, mut tau, mut dynamics) = (Vec::new(), [0.0; 2], Dynamics::new(&robot, parameters));
            for k in 0..states.len() {
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
                all.extend(tau);
            }
            all
        };
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let stiff = StiffLoop::new(&robot, columns, &own, other.clone(), states.clone(), 1e-3);
        let found = stiff.motion(&other, &Unobserved).unwrap();
        let (tau, expected) = (torque(&own), torque(&other));
        for i in 0..tau.len() {
            assert!((found.tau[i] - expected[i]).abs() < 1e-10 * expected[i].abs().max(1.0));
            assert!((found.states.q[i] - states.q[i] - 1e-3 * (tau[i] - expected[i])).abs() < 1e-12);
        }
        // Linear in the parameters: a difference over one unit is the slope. Means of two samples.
        let by: Vec<ParameterId> = columns.parameters(&robot).into_iter().step_by(3).collect();
        let (_, slopes) = stiff.slopes(&other, &by, 2, &Unobserved).unwrap();
        for (column, &id) in by.iter().enumerate() {
            let mut moved = other.clone();
            moved.set(id, other.get(id) + 1.0);
            let moved = stiff.motion(&moved, &Unobserved).unwrap();
            for (row, (by_q, by_tau)) in slopes.q.column(column).iter().zip(&slopes.tau.column(column)).enumerate() {
                let mean = |a: &[f64], b: &[f64]| {
                    let at = |k: usize| a[2 * k + row % 2] - b[2 * k + row % 2];
                    0.5 * (at(row / 2 * 2) + at(row / 2 * 2 + 1))
                };
                assert!((by_tau - mean(&moved.tau, &found.tau)).abs() < 1e-9);
                assert!((by_q - mean(&moved.states.q, &found.states.q)).abs() < 1e-9);
            }
        }
    }
}
