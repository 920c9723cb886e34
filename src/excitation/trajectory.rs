//! What a trajectory is to everything that follows it: joint positions, velocities and accelerations at any time.

use crate::dynamics::States;

/// A periodic motion of all joints of a robot, in its own coordinates (rad, m).
pub trait Trajectory: Send + Sync {
    /// Number of joints n.
    fn dof(&self) -> usize;

    /// Period, s.
    fn period_s(&self) -> f64;

    /// Position (rad), velocity (rad/s) and acceleration (rad/s²) of every joint at time `t` (s), each of length n.
    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);

    /// `count` samples of one period, at `t_k = k T / count`.
    fn sample(&self, count: usize) -> States {
        let n = self.dof();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut states = States::new(n);
        for k in 0..count {
            self.evaluate(self.period_s() * k as f64 / count as f64, &mut q, &mut qd, &mut qdd);
            states.push(&q, &qd, &qdd);
        }
        states
    }
}
