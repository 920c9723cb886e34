//! The closed loop from node to node, with its derivatives by parameters and by the state of the node.
//!
//! ```text
//! x = (q, q̇, e₋, F(ė), I)        x_{j+1} = F_j(x_j, φ)        ∂F_j/∂φ, ∂F_j/∂x_j from the same pass
//! ```
//! A node lies one sample before the blocks of its interval: the torque of a sample is the mean of what is held before and after.

use armid::dynamics::States;
use armid::estimation::{ClosedLoopError, ClosedLoopInterval, ClosedLoopNode, ClosedLoopSlopes};
use armid::experiment::{DivergenceError, JointLoop, LoopSlopes, Phase, Plant};
use armid::model::Robot;
use nalgebra::{DMatrix, DVector};

use super::walk::{Motion, runaway};
use crate::AnalyticPlant;
use crate::analytic::SlopedArm;

/// Groups of n numbers in a state: positions, velocities, and three of the servo.
const GROUPS: usize = 5;

/// Nodes `apart` blocks of `block` samples from each other along one recording, whose first sample is number `first` of `states`.
///
/// What the servo remembers there is what it would along that motion, again and again; it exerts the mean of `tau`.
pub(super) fn nodes(
    motion: &Motion,
    mut joints: JointLoop,
    (states, tau, first): (&States, &[f64], usize),
    block: usize,
    apart: usize,
) -> Vec<ClosedLoopNode> {
    let (n, samples) = (states.dof, motion.layout.period_samples);
    let (blocks, of_recording) = (samples / block, first / block);
    follow(motion, &mut joints, (states, first), |_, _| {});
    // As at the end of a period, but for integrals, which begin at zero.
    let mut begin = joints.memory();
    begin[2 * n..].fill(0.0);
    joints.recall(&begin);
    let mut missing = vec![0.0; n];
    follow(motion, &mut joints, (states, first), |sample, joints| {
        let mut own = joints.clone();
        own.step(motion.command(sample, 0), states.q(first + sample), states.qd(first + sample));
        for ((missing, tau), own) in missing.iter_mut().zip(&tau[(first + sample) * n..]).zip(own.tau()) {
            *missing += (tau - own) / samples as f64;
        }
    });
    joints.recall(&begin);
    joints.add_torque(&missing);
    let mut nodes: Vec<ClosedLoopNode> = Vec::new();
    follow(motion, &mut joints, (states, first), |sample, joints| {
        let from = (sample + 1) / block;
        if (sample + 1).is_multiple_of(block) && from < blocks && (from - 1).is_multiple_of(apart) {
            let at = first + sample;
            let blocks = of_recording + from..of_recording + (from + apart).min(blocks);
            let state = DVector::from_vec([states.q(at), states.qd(at), &joints.memory()].concat());
            nodes.push(ClosedLoopNode { blocks, follows: !nodes.is_empty(), state });
        }
    });
    nodes
}

/// The servo along a motion that repeats, linear between samples; `at` looks at it before its step at each sample.
fn follow(
    motion: &Motion,
    joints: &mut JointLoop,
    (states, first): (&States, usize),
    mut at: impl FnMut(usize, &JointLoop),
) {
    let (samples, per_sample) = (motion.layout.period_samples, motion.per_sample);
    let mut between = vec![0.0; states.dof];
    for sample in 0..samples {
        at(sample, joints);
        let (now, next) = (first + sample, first + (sample + 1) % samples);
        for step in 0..per_sample {
            let part = step as f64 / per_sample as f64;
            for (between, (now, next)) in between.iter_mut().zip(states.q(now).iter().zip(states.q(next))) {
                *between = now + part * (next - now);
            }
            joints.step(motion.command(sample, step), &between, states.qd(now));
        }
    }
}

/// What moves from node to node.
pub(super) struct Walker<'a> {
    pub(super) robot: &'a Robot,
    /// Tells whether the mass matrix is positive definite.
    pub(super) plant: AnalyticPlant,
    /// With d + s directions.
    pub(super) arm: Box<dyn SlopedArm>,
    pub(super) joints: JointLoop,
    /// d.
    pub(super) parameters: usize,
}

impl Walker<'_> {
    /// The interval of a node along a recording whose first block is number `first`.
    ///
    /// # Errors
    /// [`ClosedLoopError::MassMatrix`] or [`ClosedLoopError::Diverged`] with the time.
    pub(super) fn interval(
        &mut self,
        motion: &Motion,
        (node, first): (&ClosedLoopNode, usize),
        block: usize,
    ) -> Result<ClosedLoopInterval, ClosedLoopError> {
        let Motion { layout, table, per_sample } = motion;
        let (n, dt, begin) = (self.robot.dof(), self.joints.dt(), layout.span(Phase::Record).start);
        let (state, s) = (node.state.as_slice(), node.state.len());
        let d = self.parameters + s;
        assert_eq!(s, GROUPS * n, "a state of {GROUPS} numbers for each joint");
        let mut unit = vec![0.0; s * d];
        for i in 0..s {
            unit[i * d + self.parameters + i] = 1.0;
        }
        self.arm.begin((&state[..n], &state[n..2 * n]), (&unit[..n * d], &unit[n * d..2 * n * d]));
        self.joints.recall(&state[2 * n..]);
        let mut servo = LoopSlopes::new(n, d);
        servo.recall(&unit[2 * n * d..]);

        let m = node.blocks.len();
        let sample_of = |block_number: usize| begin + (block_number - first) * block - 1;
        let (from, to) = (sample_of(node.blocks.start) * per_sample, sample_of(node.blocks.end) * per_sample);
        let (mut q_means, mut tau_means) = (vec![0.0; n * m], vec![0.0; n * m]);
        let (mut q_slopes, mut tau_slopes) = (vec![0.0; n * m * d], vec![0.0; n * m * d]);
        let (mut before, mut before_slopes, mut qdd) = (vec![0.0; n], vec![0.0; n * d], vec![0.0; n]);
        let (mut end, mut end_slopes) = (Vec::new(), Vec::new());
        let scale = 1.0 / block as f64;
        for step in from..=to {
            let t = step as f64 * dt;
            let (q, qd) = self.arm.state();
            if let Some(reason) = runaway(self.robot, q, qd) {
                return Err(ClosedLoopError::Diverged { t, reason });
            }
            if step == to {
                end = [q, qd, &self.joints.memory()].concat();
                let (of_q, of_qd) = self.arm.slopes();
                end_slopes = [of_q, of_qd, &servo.memory()].concat();
            }
            self.joints.step(table.row(step), q, qd);
            let (of_q, of_qd) = self.arm.slopes();
            servo.step(&self.joints, of_q, of_qd);
            if step.is_multiple_of(*per_sample) && step > from {
                Plant::reset(&mut self.plant, q, qd);
                if !self.plant.definite_acceleration(self.joints.tau(), &mut qdd) {
                    return Err(ClosedLoopError::MassMatrix { t });
                }
                let at = ((step - from) / per_sample - 1) / block;
                let mean = |sums: &mut [f64], a: &[f64], b: &[f64]| {
                    for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
                        *sum += 0.5 * scale * (a + b);
                    }
                };
                mean(&mut q_means[at * n..(at + 1) * n], q, q);
                mean(&mut tau_means[at * n..(at + 1) * n], &before, self.joints.tau());
                let rows = at * n * d..(at + 1) * n * d;
                mean(&mut q_slopes[rows.clone()], of_q, of_q);
                mean(&mut tau_slopes[rows], &before_slopes, servo.tau());
            }
            if step == to {
                break;
            }
            before.copy_from_slice(self.joints.tau());
            before_slopes.copy_from_slice(servo.tau());
            if let Err(fault) = self.arm.step(self.joints.tau(), servo.tau(), dt) {
                return Err(ClosedLoopError::Diverged { t, reason: DivergenceError::Plant(fault) });
            }
        }
        let slopes = ClosedLoopSlopes {
            q: DMatrix::from_row_slice(n * m, d, &q_slopes),
            tau: DMatrix::from_row_slice(n * m, d, &tau_slopes),
        };
        let (end, end_slopes) = (DVector::from_vec(end), DMatrix::from_row_slice(s, d, &end_slopes));
        Ok(ClosedLoopInterval { q: q_means, tau: tau_means, slopes, end, end_slopes })
    }
}
