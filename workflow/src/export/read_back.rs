//! What was written against what it was made from.

use armid::conformance::chains::random_state;
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;

/// Random states at which torques are compared.
pub(super) const STATES: usize = 200;

/// Largest difference of a torque (positions, velocities and accelerations come first) from the regressor times its parameters `phi`, over the
/// largest torque of its joint.
pub(super) fn largest_difference(
    regressor: &JointTorqueRegressor,
    phi: &[f64],
    mut torque: impl FnMut(&[f64], &[f64], &[f64], &mut [f64]),
) -> f64 {
    let n = regressor.rows();
    let (mut y, mut tau) = (vec![0.0; n * phi.len()], vec![0.0; n]);
    let (mut largest, mut differences) = (vec![0.0_f64; n], vec![0.0_f64; n]);
    let mut rng = Seed::new(0).stream("read back", 0);
    for _ in 0..STATES {
        let (q, qd, qdd) = random_state(&mut rng, n);
        regressor.evaluate(&q, &qd, &qdd, &mut y);
        torque(&q, &qd, &qdd, &mut tau);
        for (i, row) in y.chunks_exact(phi.len()).enumerate() {
            let expected: f64 = row.iter().zip(phi).map(|(y, phi)| y * phi).sum();
            largest[i] = largest[i].max(expected.abs());
            differences[i] = differences[i].max((tau[i] - expected).abs());
        }
    }
    let relative = differences.iter().zip(&largest).map(|(d, size)| d / size.max(f64::MIN_POSITIVE));
    relative.fold(0.0, f64::max)
}
