//! Free motion by the core's articulated bodies and small steps of a Runge–Kutta method.

use armid::dynamics::Dynamics;
use armid::model::{Robot, StandardParameters};

/// Positions at `points` equal intervals of `interval` s each, from the state `(q, qd)` without torque, by `steps`
/// steps of the classical method of order 4 in each interval; the state itself comes first. (points + 1) rows of n.
pub(super) fn trajectory(
    robot: &Robot,
    parameters: &StandardParameters,
    q: &[f64],
    qd: &[f64],
    interval: f64,
    points: usize,
    steps: usize,
) -> Vec<Vec<f64>> {
    let n = robot.dof();
    let mut dynamics = Dynamics::new(robot, parameters);
    let still = vec![0.0; n];
    let mut slope = |y: &[f64]| {
        let mut out = vec![0.0; 2 * n];
        out[..n].copy_from_slice(&y[n..]);
        dynamics.forward_articulated(&y[..n], &y[n..], &still, &mut out[n..]);
        out
    };
    let along = |y: &[f64], k: &[f64], h: f64| -> Vec<f64> { y.iter().zip(k).map(|(y, k)| y + h * k).collect() };
    let mut y = [q, qd].concat();
    let h = interval / steps as f64;
    let mut out = vec![q.to_vec()];
    for _ in 0..points {
        for _ in 0..steps {
            let k1 = slope(&y);
            let k2 = slope(&along(&y, &k1, 0.5 * h));
            let k3 = slope(&along(&y, &k2, 0.5 * h));
            let k4 = slope(&along(&y, &k3, h));
            for i in 0..2 * n {
                y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            }
        }
        out.push(y[..n].to_vec());
    }
    out
}
