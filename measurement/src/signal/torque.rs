//! Motor current to joint torque.
//!
//! ```text
//! τ = Cᵀ diag(N_m K_m) i        q_motor = C q        (power: τᵀ q̇ = (N K i)ᵀ C q̇)
//! ```
//! with the gear ratio N and the torque constant K of each motor, and C = 1 where motors are not coupled. The rotor's
//! inertia and the drive's friction are part of the model, not of this map.

use nalgebra::DMatrix;

use crate::linalg::product::add_product;
use crate::model::{EffortInterface, Robot};

/// The matrix that turns efforts as the arm reports them (n) into joint torques (n, N·m; N for a prismatic joint): that
/// of the drives for motor currents in A, the identity for torques.
pub fn torque_map(robot: &Robot, effort: EffortInterface) -> DMatrix<f64> {
    let n = robot.dof();
    if effort == EffortInterface::Torque {
        return DMatrix::identity(n, n);
    }
    let constants: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.torque_per_ampere()).collect();
    DMatrix::from_fn(n, n, |i, j| {
        let coupling = robot.coupling().map_or(if i == j { 1.0 } else { 0.0 }, |c| c[(j, i)]);
        coupling * constants[j]
    })
}

/// `rows · mapᵀ` for a row-major table n wide: the map applied to every sample.
pub(super) fn map_rows(rows: &[f64], map: &DMatrix<f64>) -> Vec<f64> {
    let n = map.nrows();
    let is_diagonal = (0..n).all(|j| (0..n).all(|i| i == j || map[(i, j)] == 0.0));
    if is_diagonal {
        let (factors, mut out) = (map.diagonal(), rows.to_vec());
        for row in out.chunks_exact_mut(n) {
            row.iter_mut().zip(factors.as_slice()).for_each(|(x, factor)| *x *= factor);
        }
        return out;
    }
    let mut out = vec![0.0; rows.len()];
    // Samples are columns in memory.
    add_product(map.as_slice(), rows, map.nrows(), &mut out);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::ChainRecipe;
    use crate::seed::Seed;
    use nalgebra::DVector;

    #[test]
    fn identity_power_at_the_joints_is_power_at_the_motors() {
        let mut rng = Seed::new(6).stream("coupled", 0);
        let (robot, _) = ChainRecipe { coupled: true, ..ChainRecipe::new(4) }.draw(&mut rng);
        let coupling = robot.coupling().unwrap();
        let current = DVector::from_vec(vec![0.3, -1.2, 0.7, 2.0]);
        let qd = DVector::from_vec(vec![1.0, 0.2, -0.4, 0.9]);
        let motor_torque = DVector::from_fn(4, |i, _| robot.joints()[i].drive.torque_per_ampere() * current[i]);
        let at_motors = motor_torque.dot(&(coupling * &qd));
        let torque = map_rows(current.as_slice(), &torque_map(&robot, EffortInterface::Current));
        assert!((DVector::from_vec(torque).dot(&qd) - at_motors).abs() < 1e-12);
        assert_eq!(torque_map(&robot, EffortInterface::Torque), DMatrix::identity(4, 4));
    }
}
