//! What moves in the loop: an arm alone, or with the derivatives of its motion and of the servo's torque.

use armid::experiment::{JointLoop, LoopSlopes, Plant, PlantError};

use super::period_mean::Period;
use crate::AnalyticPlant;
use crate::analytic::SlopedArm;

/// An arm in the loop.
pub(super) trait Body {
    /// Puts it at rest at `q`.
    fn reset(&mut self, q: &[f64]);
    /// Joint coordinates and velocities.
    fn state(&self) -> (&[f64], &[f64]);
    /// Goes along with what the servo has decided.
    fn decided(&mut self, joints: &JointLoop);
    /// Advances by `dt` under what the servo has decided.
    fn step(&mut self, joints: &JointLoop, dt: f64) -> Result<(), PlantError>;
    /// Adds what a sample of the period has beside its motion to tables of that period, block by block.
    fn sample(&self, block: usize, tables: &mut [Vec<f64>]);
    /// Those tables, empty, for so many blocks.
    fn tables(&self, blocks: usize) -> Period;
}

impl Body for AnalyticPlant {
    fn reset(&mut self, q: &[f64]) {
        Plant::reset(self, q, &vec![0.0; q.len()]);
    }

    fn state(&self) -> (&[f64], &[f64]) {
        Plant::state(self)
    }

    fn decided(&mut self, _: &JointLoop) {}

    fn step(&mut self, joints: &JointLoop, dt: f64) -> Result<(), PlantError> {
        Plant::step(self, joints.tau(), dt)
    }

    fn sample(&self, _: usize, _: &mut [Vec<f64>]) {}

    fn tables(&self, _: usize) -> Period {
        Vec::new()
    }
}

/// An arm with the derivatives of its motion and of the servo's torque by d parameters.
pub(super) struct SlopedBody {
    pub(super) arm: Box<dyn SlopedArm>,
    pub(super) servo: LoopSlopes,
    /// ∂τ/∂φ before the last decision, n × d.
    pub(super) before: Vec<f64>,
    pub(super) fresh: bool,
}

impl SlopedBody {
    pub(super) fn new(arm: Box<dyn SlopedArm>, joints: usize, directions: usize) -> Self {
        Self { arm, servo: LoopSlopes::new(joints, directions), before: vec![0.0; joints * directions], fresh: true }
    }
}

impl Body for SlopedBody {
    fn reset(&mut self, q: &[f64]) {
        self.arm.reset(q);
    }

    fn state(&self) -> (&[f64], &[f64]) {
        self.arm.state()
    }

    fn decided(&mut self, joints: &JointLoop) {
        self.before.copy_from_slice(self.servo.tau());
        let (q, qd) = self.arm.slopes();
        self.servo.step(joints, q, qd);
        if std::mem::take(&mut self.fresh) {
            self.before.copy_from_slice(self.servo.tau());
        }
    }

    fn step(&mut self, joints: &JointLoop, dt: f64) -> Result<(), PlantError> {
        self.arm.step(joints.tau(), self.servo.tau(), dt)
    }

    fn sample(&self, block: usize, tables: &mut [Vec<f64>]) {
        let (q, _) = self.arm.slopes();
        let rows = block * q.len()..(block + 1) * q.len();
        let [of_q, of_tau] = tables else { return };
        for (sum, q) in of_q[rows.clone()].iter_mut().zip(q) {
            *sum += q;
        }
        for ((sum, before), after) in of_tau[rows].iter_mut().zip(&self.before).zip(self.servo.tau()) {
            *sum += 0.5 * (before + after);
        }
    }

    fn tables(&self, blocks: usize) -> Period {
        vec![vec![0.0; blocks * self.before.len()]; 2]
    }
}
