//! The columns of Stribeck friction at any speed at which it falls, and their derivatives.
//!
//! ```text
//! w(v_S) = d g(dᵀq̇, v_S)        ∂w/∂ln v_S = d 2 (dᵀq̇/v_S)² g        d = e_j (a joint's) or Cᵀe_j (a coupled motor's)
//! ```
//! means over blocks as all equations are, zero in rows that are no equation.

use nalgebra::{DMatrix, DVector};

use super::Observation;
use crate::model::term::{MOTOR_STRIBECK, STRIBECK, Scale, Stribeck, Term, TermInput};
use crate::model::{ParameterId, ParameterKind, Robot};
use crate::signal::Samples;

/// Smallest speed at which friction may fall, as a part of the largest of the joint.
const LEAST: f64 = 1e-3;

/// The Stribeck columns of an observation.
pub(super) struct StribeckColumns {
    /// Those of each joint that has any.
    pub(super) joints: Vec<JointColumns>,
    /// Samples that make one equation.
    block: usize,
}

/// The columns that share the Stribeck velocity of one drive: of the joint, and of its motor where that drives several joints.
pub(super) struct JointColumns {
    /// Joint, from zero.
    pub(super) joint: usize,
    /// Smallest and largest speed that is looked for.
    pub(super) bounds: [f64; 2],
    /// The Coulomb velocity of the drive.
    smooth: Scale,
    pub(super) columns: Vec<StribeckColumn>,
}

/// One column.
pub(super) struct StribeckColumn {
    /// Its place among the base columns.
    pub(super) place: usize,
    id: ParameterId,
    unit: String,
    term: Term,
    /// d.
    direction: Vec<f64>,
    /// `dᵀq̇` of every sample.
    velocity: Vec<f64>,
}

impl StribeckColumns {
    /// Those among the base columns of an observation of these samples.
    pub(super) fn of(robot: &Robot, observation: &Observation, samples: &Samples) -> Self {
        let (n, base) = (robot.dof(), &observation.base);
        let column = |(place, &kept): (usize, &usize)| {
            let id = base.parameters[kept];
            let term = [STRIBECK, MOTOR_STRIBECK].into_iter().find(|&term| id.kind == ParameterKind::Term(term))?;
            let direction: Vec<f64> = match robot.coupling().filter(|_| term.is_motors()) {
                Some(c) => c.row(id.index).iter().copied().collect(),
                None => (0..n).map(|j| if j == id.index { 1.0 } else { 0.0 }).collect(),
            };
            let velocity = (0..samples.len()).map(|k| dot(&direction, samples.states.qd(k))).collect();
            let unit = observation.parameter_units[place].clone();
            Some(StribeckColumn { place, id, unit, term, direction, velocity })
        };
        let mut joints: Vec<JointColumns> = Vec::new();
        for column in base.kept.iter().enumerate().filter_map(column) {
            let joint = column.id.index;
            if let Some(of) = joints.iter_mut().find(|of| of.joint == joint) {
                of.columns.push(column);
                continue;
            }
            let used = |k: &usize| observation.used.get(k / samples.block * n + joint).copied().unwrap_or(false);
            let speeds = || (0..samples.len()).filter(used).map(|k| column.velocity[k].abs());
            let (lowest, largest) = (speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max));
            // Nothing is told of friction that has fallen before the slowest equation.
            if largest > 0.0 {
                let bounds = [(LEAST * largest).max(0.5 * lowest), largest];
                let smooth = Scale::new(robot.joints()[joint].drive.coulomb_velocity);
                joints.push(JointColumns { joint, bounds, smooth, columns: vec![column] });
            }
        }
        Self { joints, block: samples.block }
    }

    /// The equations at these speeds, one for each of the joints.
    pub(super) fn at(&self, observation: &Observation, speeds: &[f64]) -> Observation {
        let mut changed = observation.clone();
        for (of, &speed) in self.joints.iter().zip(speeds) {
            for column in &of.columns {
                let law = |velocity| column.term.torque(&input(velocity, of.smooth, speed));
                changed.regressor.set_column(column.place, &column.rows(observation, self.block, law));
            }
        }
        changed
    }

    /// The same with a column more for each joint that is `sought`: the derivative of its torque by the logarithm of its speed, the
    /// coefficients being those of β.
    pub(super) fn with_slopes(
        &self,
        observation: &Observation,
        speeds: &[f64],
        beta: &DVector<f64>,
        sought: &[bool],
    ) -> Observation {
        let (mut slopes, mut ids, mut units) = (Vec::new(), Vec::new(), Vec::new());
        for ((of, &speed), _) in self.joints.iter().zip(speeds).zip(sought).filter(|(_, sought)| **sought) {
            let mut slope = DVector::zeros(observation.y.len());
            for column in &of.columns {
                let law = |velocity| speed * Stribeck::by_velocity(&input(velocity, of.smooth, speed));
                slope.axpy(beta[column.place], &column.rows(observation, self.block, law), 1.0);
            }
            slopes.push(slope);
            ids.push(of.columns[0].id);
            units.push(of.columns[0].unit.clone());
        }
        if slopes.is_empty() {
            return observation.clone();
        }
        observation.with_columns(&DMatrix::from_columns(&slopes), &ids, &units)
    }
}

impl StribeckColumn {
    /// `d` times the mean of a law of the velocity over each block, n·M.
    fn rows(&self, observation: &Observation, block: usize, law: impl Fn(f64) -> f64) -> DVector<f64> {
        let n = observation.dof;
        let mut rows = DVector::zeros(observation.y.len());
        for (k, velocities) in self.velocity.chunks_exact(block).enumerate() {
            let mean = velocities.iter().fold(0.0, |sum, &velocity| sum + law(velocity)) / block as f64;
            for (j, d) in self.direction.iter().enumerate() {
                let row = k * n + j;
                rows[row] = if observation.used[row] { d * mean } else { 0.0 };
            }
        }
        rows
    }
}

fn input(velocity: f64, smooth: Scale, speed: f64) -> TermInput<f64> {
    TermInput { q: 0.0, qd: velocity, qdd: 0.0, load: 0.0, warmth: 0.0, shape: [smooth, Scale::new(speed)] }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}
