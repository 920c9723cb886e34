//! Between the motors and the joints: torque constants, gears, and the coupling of motors where a robot has one.
//!
//! ```text
//! q_motor = C q        τ_motor = N Kt i        τ = Cᵀ τ_motor
//! ```
//! Motor quantities are taken after the gear, so that they have the size of joint quantities; `C` is the identity
//! where motors are not coupled. The two maps are adjoint: power is the same on both sides.

use nalgebra::DMatrix;

use crate::model::Robot;

/// Maps between motor and joint quantities of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmission {
    per_ampere: Vec<f64>,
    coupling: Option<Coupling>,
}

#[derive(Clone, Debug, PartialEq)]
struct Coupling {
    forward: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

fn multiply(matrix: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
    for i in 0..out.len() {
        out[i] = (0..x.len()).map(|j| matrix[(i, j)] * x[j]).sum();
    }
}

fn multiply_transposed(matrix: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
    for i in 0..out.len() {
        out[i] = (0..x.len()).map(|j| matrix[(j, i)] * x[j]).sum();
    }
}

impl Transmission {
    /// The transmission that a robot's file describes.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self {
            per_ampere: robot.joints().iter().map(|joint| joint.drive.torque_per_ampere()).collect(),
            coupling: robot.coupling().map(|c| Coupling {
                forward: c.clone(),
                inverse: c.clone().try_inverse().expect("a robot's coupling is invertible by construction"),
            }),
        }
    }

    /// Torque of each motor per ampere, after the gear: `N Kt`, N·m/A (N/A).
    pub fn per_ampere(&self) -> &[f64] {
        &self.per_ampere
    }

    /// C, where motors are coupled.
    pub(super) fn forward(&self) -> Option<&DMatrix<f64>> {
        self.coupling.as_ref().map(|coupling| &coupling.forward)
    }

    /// Motor coordinates from joint coordinates: `C q`; velocities likewise. Both of length n.
    pub fn motor_motion(&self, joints: &[f64], motors: &mut [f64]) {
        match &self.coupling {
            None => motors.copy_from_slice(joints),
            Some(coupling) => multiply(&coupling.forward, joints, motors),
        }
    }

    /// Joint coordinates from motor coordinates: `C⁻¹ q_motor`. Both of length n.
    pub fn joint_motion(&self, motors: &[f64], joints: &mut [f64]) {
        match &self.coupling {
            None => joints.copy_from_slice(motors),
            Some(coupling) => multiply(&coupling.inverse, motors, joints),
        }
    }

    /// Joint torques from motor torques: `Cᵀ τ_motor`, N·m (N). Both of length n.
    pub fn joint_torque(&self, motors: &[f64], joints: &mut [f64]) {
        match &self.coupling {
            None => joints.copy_from_slice(motors),
            Some(coupling) => multiply_transposed(&coupling.forward, motors, joints),
        }
    }

    /// Motor torques from joint torques: `C⁻ᵀ τ`, N·m (N). Both of length n.
    pub fn motor_torque(&self, joints: &[f64], motors: &mut [f64]) {
        match &self.coupling {
            None => motors.copy_from_slice(joints),
            Some(coupling) => multiply_transposed(&coupling.inverse, joints, motors),
        }
    }

    /// Inertia that each motor sees while the other motors stand still: the diagonal of `C⁻ᵀ H C⁻¹`, kg·m².
    pub fn motor_inertia(&self, mass_matrix: &DMatrix<f64>) -> Vec<f64> {
        match &self.coupling {
            None => mass_matrix.diagonal().iter().copied().collect(),
            Some(coupling) => {
                (coupling.inverse.transpose() * mass_matrix * &coupling.inverse).diagonal().iter().copied().collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

    #[test]
    fn identity_power_is_the_same_on_both_sides_of_a_coupling() {
        let robot = hinges::coupled();
        let transmission = Transmission::new(&robot);
        let (qd, tau_motor) = ([0.7, -0.4], [2.0, 3.0]);
        let (mut qd_motor, mut tau, mut back) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        transmission.motor_motion(&qd, &mut qd_motor);
        transmission.joint_torque(&tau_motor, &mut tau);
        transmission.joint_motion(&qd_motor, &mut back);
        let mut torque_back = [0.0; 2];
        transmission.motor_torque(&tau, &mut torque_back);
        assert!((torque_back[0] - tau_motor[0]).abs() + (torque_back[1] - tau_motor[1]).abs() < 1e-14);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&qd_motor, &tau_motor) - dot(&qd, &tau)).abs() < 1e-14);
        assert!((back[0] - qd[0]).abs() + (back[1] - qd[1]).abs() < 1e-15);
    }

    #[test]
    fn analytic_motor_inertia_behind_a_coupling() {
        // C = [1 0; 1 1] → C⁻¹ = [1 0; −1 1]; with M = diag(3, 2): C⁻ᵀ M C⁻¹ has the diagonal (3 + 2, 2).
        let transmission = Transmission::new(&hinges::coupled());
        let m = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![3.0, 2.0]));
        assert_eq!(transmission.motor_inertia(&m), [5.0, 2.0]);
    }
}
