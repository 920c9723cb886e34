//! The columns of friction whose law has a speed of its own, at any such speed, and their derivatives.
//!
//! ```text
//! w(v) = d g(dᵀq, dᵀq̇, τ_l, v)        ∂w/∂ln v by differences of fourth order        d = e_j (a joint's) or Cᵀe_j (a coupled motor's)
//! ```
//! means over blocks as all equations are, zero in rows that are no equation. The torque τ_l of the links is that of the observation.

use nalgebra::{DMatrix, DVector};

use super::observation::Observation;
use crate::linalg::dot;
use crate::model::term::{Scale, ShapeParameter, Shapes, Term, TermBlock};
use crate::model::{ParameterId, Robot};
use crate::signal::Samples;

/// Smallest speed that is looked for, as a part of the largest of the joint.
const LEAST: f64 = 1e-3;
/// Smallest speed that is looked for, as a part of the lowest among the equations of its joint: friction that has fallen, or set in, before the slowest equation shows no speed.
const LEAST_FALL: f64 = 0.5;
const LEAST_ONSET: f64 = 0.25;
/// Step of ln v of the differences.
const STEP: f64 = 1e-3;

/// The columns of an observation with a speed of one kind.
pub(super) struct SpeedColumns<'a> {
    /// Those of each joint that has any.
    pub(super) joints: Vec<JointColumns>,
    samples: &'a Samples,
}

/// The columns that share the speed of one drive: of the joint, and of its motor where that drives several joints.
pub(super) struct JointColumns {
    /// Joint, from zero.
    pub(super) joint: usize,
    /// Smallest and largest speed that is looked for.
    pub(super) bounds: [f64; 2],
    pub(super) columns: Vec<SpeedColumn>,
}

/// One column.
pub(super) struct SpeedColumn {
    /// Its place among the base columns.
    pub(super) place: usize,
    id: ParameterId,
    unit: String,
    term: Term,
    /// The shape parameters of its law, and which of them is the speed.
    shapes: Shapes,
    at: usize,
    /// d.
    direction: Vec<f64>,
    /// Position, velocity and, where the law needs it, torque of the links in its coordinate, of every sample.
    input: [Vec<f64>; 3],
}

impl<'a> SpeedColumns<'a> {
    /// Those among the base columns of an observation of these samples whose law has this shape parameter.
    pub(super) fn of(robot: &Robot, observation: &Observation, samples: &'a Samples, shape: ShapeParameter) -> Self {
        let (n, base) = (robot.dof(), &observation.base);
        let coupling = |row: usize, inverse: bool| -> Option<Vec<f64>> {
            let c = robot.coupling()?;
            let c = if inverse { c.clone().try_inverse()?.transpose() } else { c.clone() };
            Some(c.row(row).iter().copied().collect())
        };
        let load = std::cell::OnceCell::new();
        let column = |(place, &kept): (usize, &usize)| {
            let id = base.parameters[kept];
            let term = id.kind.term()?;
            let at = term.entry().shapes.iter().position(|own| *own == shape)?;
            let own = || (0..n).map(|j| if j == id.index { 1.0 } else { 0.0 }).collect();
            let row = |inverse| if term.is_motors() { coupling(id.index, inverse).unwrap_or_else(own) } else { own() };
            let (direction, share) = (row(false), row(true));
            let along = |rows: &[f64], d: &[f64]| rows.chunks_exact(n).map(|row| dot(d, row)).collect::<Vec<f64>>();
            let load = match term.entry().needs.load {
                true => along(load.get_or_init(|| loads(robot, observation, samples)), &share),
                false => Vec::new(),
            };
            let input = [along(&samples.states.q, &direction), along(&samples.states.qd, &direction), load];
            let (shapes, unit) =
                (robot.joints()[id.index].drive.shapes_of(term), observation.parameter_units[place].clone());
            Some(SpeedColumn { place, id, unit, term, shapes, at, direction, input })
        };
        let mut joints: Vec<JointColumns> = Vec::new();
        for column in base.kept.iter().enumerate().filter_map(column) {
            let joint = column.id.index;
            if let Some(of) = joints.iter_mut().find(|of| of.joint == joint) {
                of.columns.push(column);
                continue;
            }
            let used = |k: &usize| observation.used.get(k / samples.block * n + joint).copied().unwrap_or(false);
            let speeds = || (0..samples.len()).filter(used).map(|k| column.input[1][k].abs());
            let (lowest, largest) = (speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max));
            if largest > 0.0 {
                let least = if shape.smooths { LEAST_ONSET } else { LEAST_FALL };
                let bounds = [(LEAST * largest).max(least * lowest), largest];
                joints.push(JointColumns { joint, bounds, columns: vec![column] });
            }
        }
        Self { joints, samples }
    }

    /// Their places among the base columns, in the order of the joints.
    pub(super) fn places(&self) -> Vec<usize> {
        self.joints.iter().flat_map(|of| of.columns.iter().map(|column| column.place)).collect()
    }

    /// The columns at these speeds, one for each of the joints: n·M × as many as there are places.
    pub(super) fn matrix(&self, observation: &Observation, speeds: &[f64]) -> DMatrix<f64> {
        let of = self.joints.iter().zip(speeds);
        let columns = of.flat_map(|(of, &speed)| of.columns.iter().map(move |column| (column, speed)));
        let rows = columns.map(|(column, speed)| column.rows(observation, self.samples, column.law(speed)));
        DMatrix::from_columns(&rows.collect::<Vec<_>>())
    }

    /// The equations at these speeds.
    pub(super) fn observation_at(&self, observation: &Observation, speeds: &[f64]) -> Observation {
        let mut changed = observation.clone();
        for (place, column) in self.places().into_iter().zip(self.matrix(observation, speeds).column_iter()) {
            changed.regressor.set_column(place, &column);
        }
        changed
    }

    /// The derivative of the torque by the logarithm of the speed of each joint that is `sought`, the coefficients being those at each place of β:
    /// n·M × as many.
    pub(super) fn slopes(
        &self,
        observation: &Observation,
        speeds: &[f64],
        beta: impl Fn(usize) -> f64,
        sought: &[bool],
    ) -> DMatrix<f64> {
        let slope = |(of, &speed): (&JointColumns, &f64)| {
            of.columns.iter().fold(DVector::zeros(observation.y.len()), |sum, column| {
                sum + column.rows(observation, self.samples, column.slope(speed)) * beta(column.place)
            })
        };
        let of = self.joints.iter().zip(speeds).zip(sought).filter(|(_, sought)| **sought);
        let slopes: Vec<DVector<f64>> = of.map(|(of, _)| slope(of)).collect();
        if slopes.is_empty() { DMatrix::zeros(observation.y.len(), 0) } else { DMatrix::from_columns(&slopes) }
    }

    /// The equations with these slopes as further columns.
    pub(super) fn with_slopes(
        &self,
        observation: &Observation,
        speeds: &[f64],
        beta: &DVector<f64>,
        sought: &[bool],
    ) -> Observation {
        let of = self.joints.iter().zip(sought).filter(|(_, sought)| **sought).map(|(of, _)| &of.columns[0]);
        let (ids, units): (Vec<_>, Vec<_>) = of.map(|column| (column.id, column.unit.clone())).unzip();
        observation.with_columns(&self.slopes(observation, speeds, |place| beta[place], sought), &ids, &units)
    }
}

impl SpeedColumn {
    /// g of every sample at a speed.
    fn law(&self, speed: f64) -> Vec<f64> {
        let [q, qd, load] = &self.input;
        let mut shape = self.shapes;
        shape[self.at] = Scale::new(speed);
        let (shape, mut out) = (vec![shape; qd.len()], vec![0.0; qd.len()]);
        // No law with a speed depends on acceleration.
        self.term.law().torques(&TermBlock { q, qd, qdd: qd, load, warmth: &[], shape: &shape }, &mut out);
        out
    }

    /// ∂g/∂ln v of every sample: `(8 (g₊₁ − g₋₁) − (g₊₂ − g₋₂))/12h`.
    fn slope(&self, speed: f64) -> Vec<f64> {
        let at = |steps: f64| self.law(speed * libm::exp(steps * STEP));
        let [near, far] = [1.0, 2.0].map(|steps| (at(steps), at(-steps)));
        let difference = |k: usize| 8.0 * (near.0[k] - near.1[k]) - (far.0[k] - far.1[k]);
        (0..near.0.len()).map(|k| difference(k) / (12.0 * STEP)).collect()
    }

    /// `d` times the mean of a law over each block, n·M, behind the low pass of the torque.
    fn rows(&self, observation: &Observation, samples: &Samples, law: Vec<f64>) -> DVector<f64> {
        let (n, block) = (observation.dof, samples.block);
        let mut rows = DVector::zeros(observation.y.len());
        // The observation has gone through the same filter.
        let Ok(law) = samples.filtered_as_torque(law, 1) else { return rows };
        for (k, law) in law.chunks_exact(block).enumerate() {
            let mean = law.iter().sum::<f64>() / block as f64;
            for (j, d) in self.direction.iter().enumerate() {
                let row = k * n + j;
                rows[row] = if observation.used[row] { d * mean } else { 0.0 };
            }
        }
        rows
    }
}

/// Torque that the links take of each joint, N × n.
fn loads(robot: &Robot, observation: &Observation, samples: &Samples) -> Vec<f64> {
    let (regressor, states) = (observation.joint_regressor(robot), &samples.states);
    (0..states.len()).flat_map(|k| regressor.load_at(states.q(k), states.qd(k), states.qdd(k))).collect()
}
