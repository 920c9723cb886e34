//! One point β of a search, simulated, beside the samples.
//!
//! ```text
//! φ = φ_nom + Kᵀ(KKᵀ)⁻¹ (β − K φ_nom)        β → φ → q_s, q̇_s, q̈_s, τ_s
//! ```
//! Columns that are not estimated are not simulated either: the simulated arm is the estimated model.

use nalgebra::{DMatrix, DVector};

use super::descent::Linearised;
use super::error::ClosedLoopError;
use super::simulation::{
    ClosedLoop, ClosedLoopInterval, ClosedLoopIntervals, ClosedLoopMotion, ClosedLoopNode, ClosedLoopSlopes,
    CommandedLoop,
};
use crate::estimation::completion::complete;
use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::product;
use crate::model::{ParameterId, Robot, StandardParameters};
use crate::observer::Observer;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// What trial points are simulated with.
pub(super) struct Trial<'a> {
    estimator: &'a str,
    pub(super) observation: &'a Observation,
    robot: &'a Robot,
    samples: &'a Samples,
    closed_loop: &'a dyn ClosedLoop,
    start: Option<&'a StandardParameters>,
    observer: &'a dyn Observer,
    regressor: JointTorqueRegressor,
}

impl<'a> Trial<'a> {
    /// For an estimator that needs the servo.
    pub(super) fn of(estimator: &'a str, problem: &EstimationProblem<'a>) -> Result<Self, EstimationError> {
        let trial = Self::of_any_servo(estimator, problem)?;
        match trial.closed_loop.commanded().filter(|of| !of.servo().unknown.is_empty()) {
            Some(of) => {
                let parts = of.servo().unknown.iter().map(ToString::to_string).collect();
                Err(trial.failed(ClosedLoopError::ServoUnknown { parts }))
            }
            None => Ok(trial),
        }
    }

    /// For one that estimates what is not known of it.
    pub(super) fn of_any_servo(estimator: &'a str, problem: &EstimationProblem<'a>) -> Result<Self, EstimationError> {
        let robot = problem.robot_for(estimator)?;
        Ok(Self {
            estimator,
            observation: problem.observation,
            robot,
            samples: problem.samples_for(estimator)?,
            closed_loop: problem.closed_loop_for(estimator)?,
            start: problem.start,
            observer: problem.observer,
            regressor: problem.observation.joint_regressor(robot),
        })
    }

    /// The loop in intervals, where it can begin in any state.
    pub(super) fn in_intervals(&self) -> Option<&'a dyn ClosedLoopIntervals> {
        self.closed_loop.in_intervals()
    }

    /// Where a search begins: at the start that was given, else at `fit`; at the nominal set where that cannot be simulated.
    pub(super) fn beginnings(&self, fit: DVector<f64>) -> [DVector<f64>; 2] {
        let beta =
            |set: &StandardParameters| self.observation.base.beta(&set.vector(self.robot, self.observation.columns));
        [self.start.map_or(fit, beta), beta(self.closed_loop.nominal())]
    }

    /// The motion at β.
    pub(super) fn motion(&self, beta: &DVector<f64>) -> Result<ClosedLoopMotion, EstimationError> {
        let motion = self.closed_loop.motion(&self.parameters(beta)?, self.observer);
        self.checked(motion.map_err(|reason| self.failed(reason))?)
    }

    /// The motion at β, and its derivatives by β.
    pub(super) fn slopes(&self, beta: &DVector<f64>) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), EstimationError> {
        let found = self.closed_loop.slopes(&self.parameters(beta)?, &self.by(), self.samples.block, self.observer);
        let (motion, mut slopes) = found.map_err(|reason| self.failed(reason))?;
        for matrix in [&mut slopes.q, &mut slopes.tau] {
            self.blank(matrix);
        }
        Ok((self.checked(motion)?, slopes))
    }

    /// The loop of commanded joints whose servos are not known in full; `None` of any other.
    pub(super) fn unknown_servo(&self) -> Option<&'a dyn CommandedLoop> {
        self.closed_loop.commanded().filter(|of| !of.servo().unknown.is_empty())
    }

    /// Measured less simulated positions at x = (β, the servos' unknown numbers, states in which the logs begin), and their derivatives.
    pub(super) fn commanded(&self, of: &dyn CommandedLoop, x: &DVector<f64>) -> Result<Linearised, EstimationError> {
        let (b, m) = (self.observation.base.rank(), of.servo().unknown.len());
        let servo = of.servo().clone().with_unknown(&x.as_slice()[b..b + m]);
        let parameters = self.parameters(&x.rows(0, b).into_owned())?;
        let starts = &x.as_slice()[b + m..];
        let found = of.slopes_from(&parameters, &servo, starts, &self.by(), self.samples.block, self.observer);
        let (motion, mut slopes) = found.map_err(|reason| self.failed(reason))?;
        self.blank(&mut slopes.q);
        Ok(Linearised { residual: self.position_error(&self.checked(motion)?), jacobian: slopes.q })
    }

    /// Nodes so many blocks apart along the measured motion, where motors exert the torque that β makes of it.
    pub(super) fn nodes(
        &self,
        intervals: &dyn ClosedLoopIntervals,
        beta: &DVector<f64>,
        apart: usize,
    ) -> Vec<ClosedLoopNode> {
        let states = &self.samples.states;
        let w = self.regressor.stack_means(states, &self.observation.base.kept, 1);
        let tau = product(&w, &DMatrix::from_column_slice(beta.len(), 1, beta.as_slice()));
        intervals.nodes(states, tau.as_slice(), self.samples.block, apart)
    }

    /// The intervals from these nodes at β.
    pub(super) fn intervals(
        &self,
        intervals: &dyn ClosedLoopIntervals,
        beta: &DVector<f64>,
        nodes: &[ClosedLoopNode],
    ) -> Result<Vec<ClosedLoopInterval>, EstimationError> {
        let parameters = self.parameters(beta)?;
        let found = intervals.intervals(&parameters, &self.by(), self.samples.block, nodes, self.observer);
        found.map_err(|reason| self.failed(reason))
    }

    /// Parameters by which derivatives are taken: ∂φ/∂β = Kᵀ(KKᵀ)⁻¹ moves torque as the kept ones alone do.
    fn by(&self) -> Vec<ParameterId> {
        let base = &self.observation.base;
        base.kept.iter().map(|&j| base.parameters[j]).collect()
    }

    /// Z: the regressor along a simulated motion, (n·M) × b; zero in rows that are no equation.
    pub(super) fn regressor_along(&self, motion: &ClosedLoopMotion) -> DMatrix<f64> {
        let mut z = self.regressor.stack_means(&motion.states, &self.observation.base.kept, self.samples.block);
        self.blank(&mut z);
        z
    }

    /// Measured less simulated torque, n·M; zero in rows that are no equation.
    pub(super) fn torque_error(&self, motion: &ClosedLoopMotion) -> DVector<f64> {
        self.error(&self.observation.y, &motion.tau)
    }

    /// Measured positions, n·M; zero in rows that are no equation.
    pub(super) fn positions(&self) -> DVector<f64> {
        let n = self.observation.dof;
        let mut q = DVector::from_vec(self.samples.block_means(&self.samples.states.q, n));
        for (row, _) in self.observation.used.iter().enumerate().filter(|(_, used)| !**used) {
            q[row] = 0.0;
        }
        q
    }

    /// Measured less simulated positions, n·M; zero in rows that are no equation.
    pub(super) fn position_error(&self, motion: &ClosedLoopMotion) -> DVector<f64> {
        self.error(&self.positions(), &motion.states.q)
    }

    /// Means of a simulated table taken from measured means.
    fn error(&self, measured: &DVector<f64>, simulated: &[f64]) -> DVector<f64> {
        let means = self.samples.block_means(simulated, self.observation.dof);
        let used = &self.observation.used;
        DVector::from_fn(measured.len(), |row, _| if used[row] { measured[row] - means[row] } else { 0.0 })
    }

    /// A full set of standard parameters with these base parameters.
    fn parameters(&self, beta: &DVector<f64>) -> Result<StandardParameters, EstimationError> {
        let columns = self.observation.columns;
        let full = complete(&self.observation.base, beta, self.closed_loop.nominal())?.parameters;
        let phi = full.vector(self.robot, columns);
        Ok(StandardParameters::from_vector(self.robot, columns, phi.as_slice()))
    }

    fn checked(&self, motion: ClosedLoopMotion) -> Result<ClosedLoopMotion, EstimationError> {
        let (found, expected) = (motion.states.len(), self.samples.len());
        if found == expected { Ok(motion) } else { Err(self.failed(ClosedLoopError::Samples { found, expected })) }
    }

    pub(super) fn failed(&self, reason: ClosedLoopError) -> EstimationError {
        match reason {
            ClosedLoopError::Interrupted => EstimationError::Interrupted,
            reason => EstimationError::ClosedLoop { estimator: self.estimator.to_owned(), reason },
        }
    }

    fn blank(&self, matrix: &mut DMatrix<f64>) {
        for (row, _) in self.observation.used.iter().enumerate().filter(|(_, used)| !**used) {
            matrix.row_mut(row).fill(0.0);
        }
    }
}
