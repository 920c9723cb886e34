//! One drive term in its place, for engines that apply the same laws as the recursions do.

use std::sync::Arc;

use super::torque_term::{Side, TorqueTerm};
use crate::model::ParameterId;

/// A law of one joint or motor: `τ += value · d g(dᵀq̇, dᵀq̈)`, with d a unit vector or a row of the coupling matrix.
///
/// ```
/// use armid::conformance::chains;
/// use armid::dynamics::DriveTrain;
/// use armid::model::Columns;
/// let terms = DriveTrain::new(&chains::planar_2r(), Columns::RigidRotorFriction).terms();
/// let viscous = terms.iter().find(|term| term.parameter.to_string() == "Fv2").unwrap();
/// let mut tau = [0.0, 0.0];
/// viscous.add_torque(3.0, &[1.0, 2.0], &[0.0, 0.0], &mut tau);
/// assert_eq!(tau, [0.0, 6.0]);
/// ```
#[derive(Clone, Debug)]
pub struct DriveTerm {
    /// The parameter that multiplies it.
    pub parameter: ParameterId,
    pub(super) law: Arc<dyn TorqueTerm>,
    pub(super) direction: Vec<(usize, f64)>,
}

impl DriveTerm {
    /// Whether it acts on a joint or on a motor.
    #[must_use]
    pub fn side(&self) -> Side {
        self.law.side()
    }

    /// The non-zero entries `(joint, d)` of its direction.
    #[must_use]
    pub fn direction(&self) -> &[(usize, f64)] {
        &self.direction
    }

    /// `∂g/∂v` and `∂g/∂a` at its own velocity `v` and acceleration `a`.
    #[must_use]
    pub fn slopes(&self, v: f64, a: f64) -> (f64, f64) {
        self.law.slopes(self.parameter.index, v, a)
    }

    /// Adds the torque of `value` units of its parameter; `qd`, `qdd`, `tau` of length n.
    pub fn add_torque(&self, value: f64, qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        let along = |x: &[f64]| self.direction.iter().map(|&(joint, d)| d * x[joint]).sum::<f64>();
        let g = value * self.law.torque(self.parameter.index, along(qd), along(qdd));
        for &(joint, d) in &self.direction {
            tau[joint] += d * g;
        }
    }
}
