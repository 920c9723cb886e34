//! A robot with its parameters, ready to be evaluated.

use super::DriveTrain;
use crate::model::{Columns, Joint, Robot, StandardParameters};
use crate::spatial::{Force, Inertia, Motion, Placement};

/// The equations of motion of one robot with one set of parameters. Holds its workspace, so that no evaluation
/// allocates; clone it to use it on several threads.
///
/// ```
/// use armid::conformance::chains;
/// use armid::dynamics::Dynamics;
/// use armid::model::StandardParameters;
/// use armid::spatial::Inertia;
/// use nalgebra::{Matrix3, Vector3};
/// // A point mass of 2 kg at the end of the first link, 0.4 m from the shoulder, held horizontally.
/// let robot = chains::planar_2r();
/// let mut parameters = StandardParameters::zero(2);
/// parameters.links[0] = Inertia::from_com(2.0, Vector3::zeros(), Matrix3::zeros());
/// let mut tau = [0.0; 2];
/// Dynamics::new(&robot, &parameters).inverse(&[0.0; 2], &[0.0; 2], &[0.0; 2], &mut tau);
/// assert!((tau[0] - 2.0 * 9.81 * 0.4).abs() < 1e-12 && tau[1].abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct Dynamics {
    pub(super) joints: Vec<Joint>,
    pub(super) axes: Vec<Motion>,
    pub(super) links: Vec<Inertia>,
    pub(super) drives: DriveTrain,
    /// Value of each drive term's parameter.
    pub(super) drive_values: Vec<f64>,
    /// Acceleration of the base: minus gravity.
    pub(super) base_acceleration: Motion,
    pub(super) placements: Vec<Placement>,
    pub(super) forces: Vec<Force>,
}

impl Dynamics {
    /// The equations of motion of `robot` with these parameters.
    ///
    /// # Panics
    /// If the parameters are not those of as many links and drives as the robot has.
    #[must_use]
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let n = robot.dof();
        assert!(
            parameters.links.len() == n && parameters.drives.len() == n,
            "parameters of {} links and {} drives, expected {n}",
            parameters.links.len(),
            parameters.drives.len()
        );
        let drives = DriveTrain::new(robot, Columns::RigidRotorFriction);
        let drive_values = drives.terms().iter().map(|term| parameters.get(term.parameter)).collect();
        Self {
            joints: robot.joints().to_vec(),
            axes: robot.axes().to_vec(),
            links: parameters.links.clone(),
            drives,
            drive_values,
            base_acceleration: Motion::new(nalgebra::Vector3::zeros(), -robot.gravity()),
            placements: vec![Placement::identity(); n],
            forces: vec![Force::zero(); n],
        }
    }

    /// Number of joints n.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Joint efforts that produce an acceleration: recursive Newton–Euler, `O(n)`.
    ///
    /// ```text
    /// v_i = X_i v_{i-1} + S_i q̇_i                      a_i = X_i a_{i-1} + S_i q̈_i + v_i × S_i q̇_i
    /// f_i = I_i a_i + v_i ×* I_i v_i + X_{i+1}ᵀ f_{i+1}      (the paper's eq. 3)
    /// τ_i = S_iᵀ f_i + τ_drive,i                             (the paper's eq. 2)
    /// ```
    /// `q`, `qd`, `qdd` in rad, rad/s, rad/s² and `tau` in N·m, n each (m and N for a prismatic joint). Featherstone,
    /// table 5.1, in link coordinates.
    ///
    /// # Panics
    /// If a slice is shorter than n.
    pub fn inverse(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        let n = self.dof();
        let (mut v, mut a) = (Motion::zero(), self.base_acceleration);
        for i in 0..n {
            let x = self.joints[i].placement(q[i]);
            let rate = self.axes[i] * qd[i];
            v = x.motion_to_child(&v) + rate;
            a = x.motion_to_child(&a) + self.axes[i] * qdd[i] + v.cross(&rate);
            self.placements[i] = x;
            self.forces[i] = self.links[i].apply(&a) + v.cross_force(&self.links[i].apply(&v));
        }
        let mut f = Force::zero();
        for i in (0..n).rev() {
            f += self.forces[i];
            tau[i] = self.axes[i].dot(&f);
            f = self.placements[i].force_to_parent(&f);
        }
        for (term, &value) in self.drives.terms().iter().zip(&self.drive_values) {
            term.add_torque(value, qd, qdd, tau);
        }
    }
}
