//! Terms whose law depends on more than motion and torque, tested beside a set of terms that is estimated.
//!
//! ```text
//! warming      x_k = (t_k/T) q̇_k              t_k since the beginning of the record, T its length
//! current-lag  x_k = d(W β)/dt                 with the β that is estimated beside it ([`current_lag`](super::current_lag))
//! ```
//! None is a column of `--columns`: the first multiplies a temperature that no recording has, the second is an error of the report. As a *test*
//! that the term is absent both are sound: friction that changes with temperature changes over a record that is long against nothing but its own
//! length. The coefficient of `warming` is the change of viscous friction from the beginning to the end. Periods that were averaged have no
//! beginning: nothing of a warming gear shows in them.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::current_lag::LaggedTorque;
use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::model::term::{CURRENT_LAG, Term, WARM_VISCOUS};
use crate::model::{ParameterId, ParameterKind, Robot};
use crate::signal::Samples;

/// A coefficient of a supported term that is no column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeyondMotion {
    /// The word of its term.
    pub term: String,
    /// Its name.
    pub parameter: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// Columns of a term beside the equations of a set.
pub(super) struct Beside {
    parameters: Vec<ParameterId>,
    units: Vec<String>,
    /// What gives their values, for any samples.
    law: Law,
}

/// How columns follow from samples.
enum Law {
    /// Time times velocity, of these joints.
    Warming(Vec<usize>),
    /// The change of the estimated torque with time.
    CurrentLag(Box<LaggedTorque>),
}

impl Beside {
    /// The columns of the terms of a word beside the fit `beta` on the base of `observation`; `None` where the data do not carry them.
    ///
    /// # Errors
    /// [`EstimationError`] where the equations with a lag have no answer.
    pub(super) fn of(
        word: &str,
        robot: &Robot,
        observation: &Observation,
        samples: &Samples,
        beta: &[f64],
    ) -> Result<Option<Self>, EstimationError> {
        let terms: Vec<Term> = candidate_terms().into_iter().filter(|term| term.entry().name == word).collect();
        let of_motors = |term: Term| -> Vec<ParameterId> {
            let motors = (0..robot.dof()).filter(|&index| term.is_at(robot, index));
            motors.map(|index| ParameterId { kind: ParameterKind::Term(term), index }).collect()
        };
        let (law, parameters) = if terms.contains(&CURRENT_LAG) {
            let Some(lagged) = LaggedTorque::at_rest(robot, observation, samples, beta)? else { return Ok(None) };
            (Law::CurrentLag(Box::new(lagged)), of_motors(CURRENT_LAG))
        } else {
            if observation.periodic {
                return Ok(None);
            }
            let parameters = of_motors(WARM_VISCOUS);
            (Law::Warming(parameters.iter().map(|id| id.index).collect()), parameters)
        };
        let unit = |id: &ParameterId| id.kind.unit(robot.joints()[id.index].kind).to_owned();
        Ok(Some(Self { units: parameters.iter().map(unit).collect(), parameters, law }))
    }

    /// Whether they depend on when a record began, so that another one says nothing of them.
    pub(super) fn is_of_one_record(&self) -> bool {
        matches!(self.law, Law::Warming(_))
    }

    /// These equations with the columns behind their own.
    pub(super) fn extended(&self, observation: &Observation, samples: &Samples) -> Observation {
        let mut own = observation.clone();
        let columns = match &self.law {
            Law::Warming(joints) => warming(joints, samples),
            Law::CurrentLag(lagged) => {
                let rates = lagged.rates(samples);
                lagged.add_change(&rates, &mut own);
                lagged.columns(&rates)
            }
        };
        let mut extended = own.with_columns(&columns, &self.parameters, &self.units);
        extended.blank();
        extended
    }
}

/// The terms that can be candidates: those of the list, and the lag of the currents.
pub fn candidate_terms() -> Vec<Term> {
    Term::ALL.iter().copied().chain([CURRENT_LAG]).collect()
}

fn warming(joints: &[usize], samples: &Samples) -> DMatrix<f64> {
    let n = samples.dof();
    let velocity = samples.block_means(&samples.states.qd, n);
    let blocks = samples.blocks();
    DMatrix::from_fn(n * blocks, joints.len(), |row, column| {
        let share = (row / n) as f64 / blocks.max(2).saturating_sub(1) as f64;
        if row % n == joints[column] { share * velocity[row] } else { 0.0 }
    })
}
