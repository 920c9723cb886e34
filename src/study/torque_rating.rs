//! Whether a motion keeps the torque ratings of a robot, by its nominal parameters.
//!
//! ```text
//! |τ_j(k)| ≤ s r_j  at every sample k         √( Σ_k τ_j(k)² / N ) ≤ s c_j         |τ_j| ≤ s min(r_j, c_j)  of a pose at rest
//! ```
//! τ by inverse dynamics of the nominal parameters with all their torque terms, r the rating, c the continuous torque of
//! joint j; a limit that the robot does not state is infinite, so that a robot without ratings has none that is kept.

use crate::dynamics::{Dynamics, States};
use crate::model::{Robot, StandardParameters};

/// Torque by the nominal parameters against the ratings.
#[derive(Debug)]
pub(super) struct TorqueRating {
    dynamics: Dynamics,
    /// Rating and continuous torque of each joint, N·m or N.
    limits: Vec<[f64; 2]>,
    tau: Vec<f64>,
}

impl TorqueRating {
    pub(super) fn new(robot: &Robot, nominal: &StandardParameters) -> Self {
        let limits = robot.joints().iter().map(|joint| [joint.limits.torque, joint.limits.continuous_torque]);
        Self { dynamics: Dynamics::new(robot, nominal), limits: limits.collect(), tau: vec![0.0; robot.dof()] }
    }

    /// Whether equidistant states of a motion use at most this share of every rating.
    pub(super) fn holds(&mut self, states: &States, share: f64) -> bool {
        let mut squares = vec![0.0; self.limits.len()];
        for k in 0..states.len() {
            self.dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut self.tau);
            for ((tau, [peak, _]), squares) in self.tau.iter().zip(&self.limits).zip(&mut squares) {
                if tau.abs() > share * peak {
                    return false;
                }
                *squares += tau * tau;
            }
        }
        let samples = states.len() as f64;
        let mut means = squares.iter().zip(&self.limits);
        means.all(|(squares, [_, continuous])| (squares / samples).sqrt() <= share * continuous)
    }

    /// Whether the arm can rest at a pose (n, rad or m) for ever with at most this share of every rating.
    pub(super) fn holds_at_rest(&mut self, pose: &[f64], share: f64) -> bool {
        let rest = vec![0.0; pose.len()];
        self.dynamics.inverse(pose, &rest, &rest, &mut self.tau);
        let mut efforts = self.tau.iter().zip(&self.limits);
        efforts.all(|(tau, [peak, continuous])| tau.abs() <= share * peak.min(*continuous))
    }
}
