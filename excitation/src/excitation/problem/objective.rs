//! What makes a design good: a criterion of the information on the base parameters.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::DMatrix;
use rand::RngExt;

use super::space::DesignSpace;
use crate::base::{BaseReduction, Method, reduce, reduce_on};
use crate::dynamics::States;
use crate::excitation::criterion::Criterion;
use crate::excitation::error::{ExcitationError, finite};
use crate::excitation::evaluation::EvaluationMotions;
use crate::excitation::expected::ExpectedEffects;
use crate::model::{Columns, ReferenceUnits, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;

/// The least number of random states on which a base of frozen joints is found.
const RANDOM_STATES: usize = 40;

/// Samples of one period in the criterion, by default.
const SAMPLES: usize = 100;

/// Recorded periods of an experiment, where nothing else is said.
const RECORDED_PERIODS: f64 = 10.0;

/// What is minimised: a criterion of the information that a motion collects on the base of the chosen columns. Made and
/// changed through [`DesignProblem`](super::DesignProblem), whose robot and space it fits.
#[derive(Clone, Debug)]
pub struct DesignObjective {
    /// Which parameters are to be estimated.
    pub columns: Columns,
    /// Their base for the joints that move: the criterion is that of its kept columns.
    pub base: BaseReduction,
    /// What is minimised.
    pub criterion: Arc<dyn Criterion>,
    pub(crate) samples: usize,
    /// Noise of each joint's torque, N·m (n), for the criteria that weight rows; all 1 without it.
    pub noise: Option<Vec<f64>>,
    /// Information already collected, b × b per torque row of one period, weighted by the same noise; for the criteria
    /// that weight rows.
    pub prior: Option<DMatrix<f64>>,
    pub(super) evaluation: Option<EvaluationMotions>,
    /// Effects that the criterion expects, where it does.
    pub expected: Option<ExpectedEffects>,
    pub(super) rows: Option<f64>,
    /// Units in which errors of unlike parameters are added: by a certificate, and by a criterion that asks for units.
    pub reference_units: ReferenceUnits,
}

impl DesignObjective {
    /// On a base of motions in which every joint moves.
    pub(super) fn new(robot: &Robot, columns: Columns, criterion: Arc<dyn Criterion>) -> Result<Self, ExcitationError> {
        let base = reduce(robot, columns, Method::Structural, Seed::new(0))?;
        let objective = Self {
            columns,
            base,
            criterion,
            samples: SAMPLES,
            noise: None,
            prior: None,
            evaluation: None,
            expected: None,
            rows: None,
            reference_units: ReferenceUnits::default(),
        };
        Ok(objective.told_units())
    }

    /// The criterion as the optimiser sees it: smoothed to `sharpness` where it has kinks.
    pub(crate) fn smoothed(&self, sharpness: f64) -> Arc<dyn Criterion> {
        self.criterion.smoothed(sharpness).map_or_else(|| Arc::clone(&self.criterion), Arc::from)
    }

    /// Unit of each base parameter.
    pub(crate) fn units(&self) -> Vec<f64> {
        let unit = |&column: &usize| self.reference_units.unit(self.base.parameters[column].kind);
        self.base.kept.iter().map(unit).collect()
    }

    /// With the unit of each base parameter told to a criterion that asks.
    pub(super) fn told_units(mut self) -> Self {
        if let Some(criterion) = self.criterion.in_units(&self.units()) {
            self.criterion = criterion.into();
        }
        self
    }

    /// Tells the criterion what the estimate is for, if it asks.
    pub(super) fn declare(
        &mut self,
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        space: &DesignSpace,
    ) -> Result<(), ExcitationError> {
        if !self.criterion.asks_for_prediction() {
            return Ok(());
        }
        let motions = self.evaluation.clone().map_or_else(|| EvaluationMotions::default_for(robot), Ok)?;
        let usual = robot.dof() as f64 * space.period_s * robot.servo().rate_hz * RECORDED_PERIODS;
        let rows = self.rows.unwrap_or(usual);
        let prediction = motions.prediction(robot, regressor, &self.base, &space.frozen, self.expected.as_ref(), rows);
        if let Some(criterion) = self.criterion.for_prediction(prediction) {
            self.criterion = criterion.into();
        }
        Ok(())
    }

    /// Position, among the kept columns, of those that belong to rigid bodies.
    pub fn rigid_positions(&self) -> Vec<usize> {
        let rigid = |&(_, &column): &(usize, &usize)| self.base.parameters[column].kind.term().is_none();
        self.base.kept.iter().enumerate().filter(rigid).map(|(position, _)| position).collect()
    }

    /// Noise of each joint for the rows of the criterion: all 1 where it does not weight them.
    pub(crate) fn row_noise(&self, joints: usize) -> Vec<f64> {
        let noise = self.noise.clone().filter(|_| self.criterion.is_weighted());
        noise.unwrap_or_else(|| vec![1.0; joints])
    }

    /// This objective on the base of the joints that move in another space.
    pub(super) fn in_space(&self, robot: &Robot, space: &DesignSpace) -> Result<Self, ExcitationError> {
        let base = if space.frozen.iter().all(Option::is_none) {
            reduce(robot, self.columns, Method::Structural, Seed::new(0))?
        } else {
            let states = random_states(robot.dof(), self.base.parameters.len(), &space.frozen);
            reduce_on(robot, self.columns, Method::Qr, &states)?
        };
        if let Some(prior) = &self.prior {
            check_prior(prior, &base)?;
        }
        Ok(Self { base, ..self.clone() }.told_units())
    }
}

/// Prior information must be that of the base parameters.
pub(super) fn check_prior(prior: &DMatrix<f64>, base: &BaseReduction) -> Result<(), ExcitationError> {
    let (expected, (rows, columns)) = (base.rank(), prior.shape());
    if (rows, columns) != (expected, expected) {
        return Err(ExcitationError::PriorSize { rows, columns, expected });
    }
    prior.iter().try_for_each(|&entry| finite("entry of the prior information", entry, ""))
}

/// Random states of the joints that move, the others where they stand.
fn random_states(n: usize, parameters: usize, frozen: &[Option<f64>]) -> States {
    let count = RANDOM_STATES.max(3 * parameters / n);
    let mut rng = Seed::new(0).stream("frozen joints", 0);
    let mut states = States::new(n);
    for _ in 0..count {
        let mut draw = |size: f64, still: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let drawn = (0..n).map(|j| (size * rng.random_range(-PI..PI), frozen[j]));
            drawn.map(|(x, place)| place.map_or(x, still)).collect()
        };
        // Rates at which the arm's own motion weighs as much as gravity.
        let (q, qd, qdd) = (draw(1.0, &|place| place), draw(2.0, &|_| 0.0), draw(5.0, &|_| 0.0));
        states.push(&q, &qd, &qdd);
    }
    states
}
