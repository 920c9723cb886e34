//! One drive term in its place: what an engine needs that has equations of motion of its own.

use std::sync::Arc;

use super::torque_term::TorqueTerm;
use crate::model::ParameterId;

/// One law of one joint or motor, with the direction in joint space in which it acts.
///
/// ```text
/// τ += φ d g(dᵀq̇, dᵀq̈)
/// ```
///
/// ```
/// use armid::{conformance::chains, dynamics::DriveTrain, model::Columns};
/// let terms = DriveTrain::new(&chains::planar_2r(), Columns::RigidRotorFriction).terms();
/// // The elbow's viscous friction, 2 N·m·s/rad at 3 rad/s.
/// let mut tau = [0.0; 2];
/// terms[5].add_torque(2.0, &[0.0, 3.0], &mut tau);
/// assert_eq!((terms[5].parameter().to_string().as_str(), tau), ("Fv2", [0.0, 6.0]));
/// ```
#[derive(Clone, Debug)]
pub struct DriveTerm {
    pub(super) parameter: ParameterId,
    pub(super) law: Arc<dyn TorqueTerm>,
    pub(super) direction: Vec<(usize, f64)>,
}

impl DriveTerm {
    /// The parameter `φ` that multiplies the law.
    #[must_use]
    pub const fn parameter(&self) -> ParameterId {
        self.parameter
    }

    /// The entries `(joint, d)` of its direction that are not zero: one, unless motors are coupled.
    #[must_use]
    pub fn direction(&self) -> &[(usize, f64)] {
        &self.direction
    }

    /// The velocity of its own coordinate, `dᵀ q̇`.
    #[must_use]
    pub fn speed(&self, qd: &[f64]) -> f64 {
        self.direction.iter().fold(0.0, |sum, &(joint, d)| sum + d * qd[joint])
    }

    /// The law's slopes `(∂g/∂v, ∂g/∂a)` at the velocity `speed` of its own coordinate.
    #[must_use]
    pub fn slopes(&self, speed: f64) -> (f64, f64) {
        self.law.slopes(self.parameter.index, speed, 0.0)
    }

    /// Adds the torque of `value` units of the parameter at the joint velocities `qd`, without acceleration; n each.
    pub fn add_torque(&self, value: f64, qd: &[f64], tau: &mut [f64]) {
        let g = value * self.law.torque(self.parameter.index, self.speed(qd), 0.0);
        for &(joint, d) in &self.direction {
            tau[joint] += d * g;
        }
    }
}
