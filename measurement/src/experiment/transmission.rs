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
    /// Torque of each motor per ampere, after the gear: `N Kt`, N·m/A (N/A).
    pub per_ampere: Vec<f64>,
    /// C, where motors are coupled.
    pub(super) forward: Option<DMatrix<f64>>,
    inverse: Option<DMatrix<f64>>,
}

/// Sums of `x` by the entries of a matrix, in either order; `x` itself without one.
fn combine(matrix: Option<&DMatrix<f64>>, entry: impl Fn(usize, usize) -> (usize, usize), x: &[f64], out: &mut [f64]) {
    let Some(matrix) = matrix else { return out.copy_from_slice(x) };
    for (i, out) in out.iter_mut().enumerate() {
        *out = x.iter().enumerate().map(|(j, x)| matrix[entry(i, j)] * x).sum();
    }
}

impl Transmission {
    /// The transmission that a robot's file describes.
    pub fn new(robot: &Robot) -> Self {
        let inverse =
            |c: &DMatrix<f64>| c.clone().try_inverse().expect("a robot's coupling is invertible by construction");
        Self {
            per_ampere: robot.joints().iter().map(|joint| joint.drive.torque_per_ampere()).collect(),
            forward: robot.coupling().cloned(),
            inverse: robot.coupling().map(inverse),
        }
    }

    /// Motor coordinates from joint coordinates: `C q`; velocities likewise. Both of length n.
    pub fn motor_motion(&self, joints: &[f64], motors: &mut [f64]) {
        combine(self.forward.as_ref(), |i, j| (i, j), joints, motors);
    }

    /// The same: the joints' own, not copied, where motors are not coupled; else in `room`.
    pub(super) fn motor_view<'a>(&self, joints: &'a [f64], room: &'a mut [f64]) -> &'a [f64] {
        if self.forward.is_none() {
            return joints;
        }
        self.motor_motion(joints, room);
        room
    }

    /// Joint coordinates from motor coordinates: `C⁻¹ q_motor`. Both of length n.
    pub fn joint_motion(&self, motors: &[f64], joints: &mut [f64]) {
        combine(self.inverse.as_ref(), |i, j| (i, j), motors, joints);
    }

    /// Joint torques from motor torques: `Cᵀ τ_motor`, N·m (N). Both of length n.
    pub fn joint_torque(&self, motors: &[f64], joints: &mut [f64]) {
        combine(self.forward.as_ref(), |i, j| (j, i), motors, joints);
    }

    /// Motor torques from joint torques: `C⁻ᵀ τ`, N·m (N). Both of length n.
    pub fn motor_torque(&self, joints: &[f64], motors: &mut [f64]) {
        combine(self.inverse.as_ref(), |i, j| (j, i), joints, motors);
    }

    /// Inertia that each motor sees while the other motors stand still: the diagonal of `C⁻ᵀ H C⁻¹`, kg·m².
    pub fn motor_inertia(&self, mass_matrix: &DMatrix<f64>) -> Vec<f64> {
        let seen = match &self.inverse {
            None => mass_matrix.diagonal(),
            Some(inverse) => (inverse.transpose() * mass_matrix * inverse).diagonal(),
        };
        seen.iter().copied().collect()
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
