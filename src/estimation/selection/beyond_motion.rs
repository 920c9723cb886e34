//! Terms whose law depends on more than the motion, tested beside a set of terms that is estimated.
//!
//! ```text
//! load       x_k = |τ_l,k| tanh(q̇_k/v_s)    τ_l = W_links β̂ of the set itself        is its coefficient zero?
//! warming    x_k = (t_k/T) q̇_k              t_k since the beginning of the record, T its length
//! ```
//! Neither is a column of `--columns`: the first multiplies parameters that are estimated beside it, the second a temperature that no
//! recording has. As a *test* that the term is absent both are sound: without it, the error of τ_l is of second order in what is
//! tested, and friction that changes with temperature changes over a record that is long against nothing but its own length.
//! The coefficient of `load` is that of one step of an iteration, that of `warming` the change of viscous friction from the beginning to the
//! end. Periods that were averaged have no beginning: nothing of a warming gear shows in them.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use crate::base::Category;
use crate::estimation::Observation;
use crate::model::term::{Term, WARM_VISCOUS};
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;
use crate::spatial::Inertia;

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
    /// By a regressor with the torque of links, the last columns of it.
    Load(Box<JointTorqueRegressor>),
    /// Time times velocity, of these joints.
    Warming(Vec<usize>),
}

impl Beside {
    /// The columns of the terms of a word, the torque that the links take being that of `beta` on the base of `observation`; `None` where the
    /// data do not carry them.
    pub(super) fn of(word: &str, robot: &Robot, observation: &Observation, beta: &[f64]) -> Option<Self> {
        let terms: Vec<Term> = Term::ALL.iter().copied().filter(|term| term.entry().name == word).collect();
        let (law, parameters) = if terms.iter().any(|term| term.entry().needs.load) {
            let columns = terms.into_iter().fold(Columns::RIGID, Columns::with);
            let regressor = JointTorqueRegressor::with_load(robot, columns, &links(robot, observation, beta));
            let parameters = regressor.parameters()[10 * robot.dof()..].to_vec();
            (Law::Load(Box::new(regressor)), parameters)
        } else {
            if observation.periodic {
                return None;
            }
            let joints: Vec<usize> = (0..robot.dof()).filter(|&joint| WARM_VISCOUS.is_at(robot, joint)).collect();
            let id = |&index: &usize| ParameterId { kind: ParameterKind::Term(WARM_VISCOUS), index };
            let parameters = joints.iter().map(id).collect();
            (Law::Warming(joints), parameters)
        };
        let unit = |id: &ParameterId| id.kind.unit(robot.joints()[id.index].kind).to_owned();
        Some(Self { units: parameters.iter().map(unit).collect(), parameters, law })
    }

    /// Whether they depend on when a record began, so that another one says nothing of them.
    pub(super) fn is_of_one_record(&self) -> bool {
        matches!(self.law, Law::Warming(_))
    }

    /// These equations with the columns behind their own.
    pub(super) fn extended(&self, observation: &Observation, samples: &Samples) -> Observation {
        let (rows, b, added) = (observation.y.len(), observation.base.rank(), self.parameters.len());
        let mut columns = self.columns(samples);
        for (row, _) in observation.used.iter().enumerate().filter(|(_, used)| !**used) {
            columns.row_mut(row).fill(0.0);
        }
        let mut regressor = DMatrix::zeros(rows, b + added);
        regressor.columns_mut(0, b).copy_from(&observation.regressor);
        regressor.columns_mut(b, added).copy_from(&columns);
        let mut base = observation.base.clone();
        let p = base.parameters.len();
        let mut k = DMatrix::zeros(b + added, p + added);
        k.view_mut((0, 0), (b, p)).copy_from(&base.k);
        k.view_mut((b, p), (added, added)).fill_with_identity();
        base.k = k;
        base.kept.extend(p..p + added);
        base.categories.extend(std::iter::repeat_n(Category::Identifiable, added));
        base.parameters.extend(&self.parameters);
        let mut parameter_units = observation.parameter_units.clone();
        parameter_units.extend(self.units.iter().cloned());
        Observation { regressor, base, parameter_units, ..observation.clone() }
    }

    fn columns(&self, samples: &Samples) -> DMatrix<f64> {
        match &self.law {
            Law::Load(regressor) => {
                let last: Vec<usize> = (regressor.cols() - self.parameters.len()..regressor.cols()).collect();
                regressor.stack_means(&samples.states, &last, samples.block)
            }
            Law::Warming(joints) => {
                let n = samples.dof();
                let velocity = samples.block_means(&samples.states.qd, n);
                let blocks = samples.blocks();
                DMatrix::from_fn(n * blocks, joints.len(), |row, column| {
                    let share = (row / n) as f64 / blocks.max(2).saturating_sub(1) as f64;
                    if row % n == joints[column] { share * velocity[row] } else { 0.0 }
                })
            }
        }
    }
}

/// Links with the torque of β on a base: its representatives have its values, all other parameters are zero.
fn links(robot: &Robot, observation: &Observation, beta: &[f64]) -> StandardParameters {
    let mut phi = vec![0.0; observation.base.parameters.len()];
    for (&column, &value) in observation.base.kept.iter().zip(beta) {
        phi[column] = value;
    }
    let mut parameters = StandardParameters::zero(robot.dof());
    for (link, ten) in parameters.links.iter_mut().zip(phi.chunks_exact(10)) {
        *link = Inertia::from_array(ten.first_chunk().expect("ten of each link"));
    }
    parameters
}
