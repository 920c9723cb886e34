//! Between the optimiser's variables and the motion: every family is linear in its coefficients.
//!
//! Joint j owns the block `x_j` of its coefficients, each divided by a scale of the joint's own size, so that a step
//! of one means something similar in every variable; a frozen joint owns none:
//!
//! ```text
//! q_j(θ) = B_q(θ) S_j x_j      q̇_j(θ) = B_v(θ) S_j x_j      q̈_j(θ) = B_a(θ) S_j x_j          θ = ωt
//! ```
//! The rows B are the shape functions of the family and their derivatives with respect to time.

use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::error::{ExcitationError, above_zero, at_least_one, finite, same_joints, same_length};
use super::problem::DesignSpace;
use crate::model::{Limits, Robot};
use crate::trajectory::{
    FourierTrajectory, MotionScale, PeriodicTrajectory, Quantity, ShapeFunctions, TrajectoryFamily,
};

/// How one joint moves.
#[derive(Clone, Debug)]
pub(super) struct JointMotion {
    name: String,
    /// Its variables; none where it is frozen.
    variables: Range<usize>,
    /// Its harmonics H.
    harmonics: usize,
    /// Index of its shape.
    pub(super) shape: usize,
    /// Scale of each coefficient.
    pub(super) scales: Vec<f64>,
    /// Where it stands still, rad.
    frozen: Option<f64>,
}

/// Period, harmonics, frozen joints and scales of a family of trajectories of one robot.
#[derive(Clone, Debug)]
pub struct MotionBasis {
    pub(super) family: Arc<dyn TrajectoryFamily>,
    period_s: f64,
    /// The different shapes; joints of equally many harmonics share one.
    pub(super) shapes: Vec<Arc<dyn ShapeFunctions>>,
    pub(super) joints: Vec<JointMotion>,
}

impl MotionBasis {
    /// The variables of a `space` of `robot`'s trajectories.
    ///
    /// # Errors
    /// [`ExcitationError`] if the space is of another number of joints, a joint that moves has fewer harmonics than the
    /// family needs, no joint moves, or a joint stands still outside its limits.
    pub fn new(robot: &Robot, space: &DesignSpace) -> Result<Self, ExcitationError> {
        let (family, period_s) = (Arc::clone(&space.family), space.period_s);
        above_zero("period", period_s, "s")?;
        same_length("numbers of harmonics", space.harmonics.len(), robot.dof())?;
        same_length("places of frozen joints", space.frozen.len(), robot.dof())?;
        let omega = TAU / period_s;
        let (mut shapes, mut kinds, mut joints, mut next) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for ((joint, &harmonics), &frozen) in robot.joints().iter().zip(&space.harmonics).zip(&space.frozen) {
            let least = family.least_harmonics();
            if let Some(place) = frozen {
                finite("frozen position", place, "rad")?;
                let range = joint.limits.position;
                if !(place >= range.0 && place <= range.1) {
                    return Err(ExcitationError::FrozenOutside { joint: joint.name.clone(), found: place, range });
                }
            } else if harmonics < least {
                let joint = joint.name.clone();
                let family = family.name();
                return Err(ExcitationError::TooFewHarmonics { joint, found: harmonics, least, family });
            }
            let harmonics = harmonics.max(least);
            let shape = kinds.iter().position(|&known| known == harmonics).unwrap_or_else(|| {
                kinds.push(harmonics);
                shapes.push(family.shape(period_s, harmonics));
                kinds.len() - 1
            });
            let count = if frozen.is_some() { 0 } else { shapes[shape].count() };
            joints.push(JointMotion {
                name: joint.name.clone(),
                variables: next..next + count,
                harmonics,
                shape,
                scales: shapes[shape].scales(&motion_scale(&joint.limits, omega)),
                frozen,
            });
            next += count;
        }
        at_least_one("joints that move", next)?;
        Ok(Self { family, period_s, shapes, joints })
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Period T, s.
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Fundamental angular frequency ω, rad/s.
    pub fn omega(&self) -> f64 {
        TAU / self.period_s
    }

    /// Number of variables.
    pub fn variables(&self) -> usize {
        self.joints.last().map_or(0, |joint| joint.variables.end)
    }

    /// The variables of joint `index`; none where it is frozen.
    pub fn range(&self, index: usize) -> Range<usize> {
        self.joints[index].variables.clone()
    }

    /// The coefficients of joint `index`, from all variables.
    pub(super) fn unscaled(&self, index: usize, x: &[f64]) -> Vec<f64> {
        let joint = &self.joints[index];
        match joint.frozen {
            Some(place) => self.shapes[joint.shape].constant().iter().map(|one| place * one).collect(),
            None => x[joint.variables.clone()].iter().zip(&joint.scales).map(|(x, scale)| scale * x).collect(),
        }
    }

    /// The trajectory of the variables `x`.
    pub fn trajectory(&self, x: &[f64]) -> PeriodicTrajectory {
        let joints = self.joints.iter().enumerate().map(|(j, joint)| (joint.name.clone(), self.unscaled(j, x)));
        self.family.trajectory(self.period_s, joints.collect())
    }

    /// The variables of a trajectory; harmonics that it lacks are zero, and what frozen joints do in it does not count.
    ///
    /// # Errors
    /// [`ExcitationError`] if its joints, its period or its harmonics are not of this family.
    pub fn coefficients(&self, trajectory: &PeriodicTrajectory) -> Result<Vec<f64>, ExcitationError> {
        same_joints(trajectory.dof(), self.dof())?;
        if (trajectory.period_s() - self.period_s).abs() > 1e-12 * self.period_s {
            return Err(ExcitationError::OtherPeriod { found: trajectory.period_s(), expected: self.period_s });
        }
        let mut x = vec![0.0; self.variables()];
        for (index, joint) in self.joints.iter().enumerate().filter(|(_, joint)| joint.frozen.is_none()) {
            let values = self.family.coefficients(trajectory, index, joint.harmonics)?;
            for ((x, value), scale) in x[joint.variables.clone()].iter_mut().zip(&values).zip(&joint.scales) {
                *x = value / scale;
            }
        }
        Ok(x)
    }

    /// The variables of the trajectory that comes nearest to a Fourier series: the series' own coefficients where the
    /// family has them, else least squares of its positions.
    ///
    /// # Errors
    /// [`ExcitationError`] if the joints, the period or the harmonics of the series are not this basis's.
    pub fn nearest(&self, series: &FourierTrajectory) -> Result<Vec<f64>, ExcitationError> {
        if let Some(member) = self.family.of_series(series) {
            return self.coefficients(&member);
        }
        let blocks = (0..self.dof()).map(|j| {
            let joint = &self.joints[j];
            (joint.name.clone(), fit(&*self.shapes[joint.shape], &series.position(j)))
        });
        self.coefficients(&self.family.trajectory(self.period_s, blocks.collect()))
    }

    /// The row of one quantity of joint `index` at phase `phase`, times `sign`: one entry for each of its variables.
    pub fn row(&self, index: usize, quantity: Quantity, phase: f64, sign: f64) -> Vec<f64> {
        let mut row = self.derivative_row(index, quantity as usize, phase);
        for entry in &mut row {
            *entry *= sign;
        }
        row
    }

    /// The row of the derivative of this order (0 position … 3 jerk) of joint `index` at phase `phase`.
    pub fn derivative_row(&self, index: usize, order: usize, phase: f64) -> Vec<f64> {
        let mut row = vec![0.0; self.range(index).len()];
        self.fill_derivative_row(index, order, phase, &mut row);
        row
    }

    /// Writes [`Self::derivative_row`] into a slice of its length.
    pub(super) fn fill_derivative_row(&self, index: usize, order: usize, phase: f64, row: &mut [f64]) {
        let joint = &self.joints[index];
        if joint.frozen.is_some() {
            return;
        }
        self.shapes[joint.shape].fill(phase, order, row);
        for (entry, scale) in row.iter_mut().zip(&joint.scales) {
            *entry *= scale;
        }
    }

    /// Adds to `sum`, a slice over all variables, the weighted rows of position, velocity and acceleration of joint
    /// `index` at phase `phase`; `row` is room to work in, of any length.
    pub(super) fn add_combined_row(
        &self,
        index: usize,
        phase: f64,
        weights: [f64; 3],
        row: &mut Vec<f64>,
        sum: &mut [f64],
    ) {
        let own = &mut sum[self.range(index)];
        row.resize(2 * own.len(), 0.0);
        let (total, row) = row.split_at_mut(own.len());
        total.fill(0.0);
        for (order, weight) in weights.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0) {
            self.fill_derivative_row(index, order, phase, row);
            for (total, entry) in total.iter_mut().zip(&*row) {
                *total += weight * entry;
            }
        }
        for (own, total) in own.iter_mut().zip(&*total) {
            *own += total;
        }
    }
}

/// How far and how fast a joint can move.
fn motion_scale(limits: &Limits, omega: f64) -> MotionScale {
    let half = 0.5 * (limits.position.1 - limits.position.0);
    let range = if half.is_finite() { half } else { PI };
    let speed = limits.velocity.min(limits.acceleration / omega).min(range * omega);
    MotionScale { range, speed, omega }
}

/// Coefficients whose positions come nearest to a curve on eight samples for each of them.
fn fit(shape: &dyn ShapeFunctions, curve: &crate::trajectory::TrigonometricPolynomial) -> Vec<f64> {
    let samples = 8 * shape.count();
    let phase = |k: usize| TAU * k as f64 / samples as f64;
    let mut system = DMatrix::zeros(samples, shape.count());
    let mut row = vec![0.0; shape.count()];
    for k in 0..samples {
        shape.fill(phase(k), 0, &mut row);
        system.row_mut(k).copy_from_slice(&row);
    }
    let values = DVector::from_fn(samples, |k, _| curve.value(phase(k)));
    let normal = system.tr_mul(&system).cholesky().expect("shape functions are independent");
    normal.solve(&system.tr_mul(&values)).iter().copied().collect()
}
