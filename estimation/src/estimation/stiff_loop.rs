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
    #[must_use]
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
