//! Kinetic and potential energy.

use nalgebra::Vector3;

use super::model::Dynamics;
use crate::spatial::{Motion, Placement};

/// Energy of an arm, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Of the links and the rotors that move.
    pub kinetic: f64,
    /// In the field of gravity, zero at the base's origin, and in springs.
    pub potential: f64,
}

impl Energy {
    /// Kinetic plus potential energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

impl Dynamics {
    /// The energy at positions `q` (n, rad) and velocities `qd` (n, rad/s).
    ///
    /// ```text
    /// T = ½ Σ v_iᵀ I_i v_i + ½ q̇ᵀ H_terms q̇        V = −Σ gᵀ (m_i p_i + R_i h_i) + Σ φ E_term(q)
    /// ```
    /// It is computed from poses and velocities in link frames, without the mass matrix.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn energy(&self, q: &[f64], qd: &[f64]) -> Energy {
        let n = self.dof();
        let gravity: Vector3<f64> = -self.base_acceleration.lin;
        let (mut kinetic, mut potential) = (0.0, 0.0);
        let mut v = Motion::zero();
        let mut pose = Placement::identity();
        for i in 0..n {
            let x = self.poses[i].placement(q[i]);
            pose = pose.compose(&x);
            v = x.motion_to_child(&v) + self.axes[i] * qd[i];
            let link = &self.links[i];
            kinetic += 0.5 * v.dot(&link.apply(&v));
            potential -= gravity.dot(&(pose.translation * link.mass + pose.rotation * link.first_moment));
            for j in 0..n {
                kinetic += 0.5 * qd[i] * self.term_inertia[i * n + j] * qd[j];
            }
        }
        potential += self.terms.potential(&self.term_values, &q[..n]);
        Energy { kinetic, potential }
    }
}
