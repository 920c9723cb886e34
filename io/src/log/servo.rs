//! The torque of a position servo, from what it was commanded and what was measured.
//!
//! ```text
//! τ(t) = Kp (q_cmd(t − d) − q(t)) − Kd q̇(t)
//! ```
//! with stiffness Kp and damping Kd, both diagonal, and a delay d. It is the law of MuJoCo's position actuators, of Isaac Lab's implicit
//! ones and, between their limits, of servos that are set by position. Where a servo reaches its limit, or integrates, this is not its
//! torque.

use armid::estimation::PositionServo;

use super::mapping::ColumnMap;
use crate::error::Error;

/// The servos of a mapping of commands.
///
/// # Errors
/// [`Error`] where a list is neither of one value nor of `n`, or an unknown number is of another joint.
pub(super) fn of_map(map: &ColumnMap, n: usize) -> Result<PositionServo, Error> {
    let gain = |list: &Option<Vec<f64>>, what| map.of_each(list.as_deref(), 0.0, what, n);
    let servo = PositionServo {
        unknown: map.unknown.clone().unwrap_or_default(),
        ..PositionServo::new(gain(&map.kp, "kp")?, gain(&map.kd, "kd")?, map.delay_s.unwrap_or(0.0))
    };
    match servo.fault(n) {
        Some(fault) => Err(Error::new(format!("q_cmd: {fault}"))),
        None => Ok(servo),
    }
}

/// One sentence on the torque that it makes.
pub(super) fn remark(servo: &PositionServo, measured_velocity: bool) -> String {
    let listed = |gains: &[f64]| gains.iter().map(f64::to_string).collect::<Vec<_>>().join("/");
    let velocity = if measured_velocity { "as it was measured" } else { "from the positions" };
    let guessed = match &servo.unknown[..] {
        [] => String::new(),
        unknown => {
            let names: Vec<String> = unknown.iter().map(ToString::to_string).collect();
            format!("; {} is a guess that is estimated", names.join(", "))
        }
    };
    let delay =
        if servo.delay_s > 0.0 { format!(", {} ms after the command", 1e3 * servo.delay_s) } else { String::new() };
    format!(
        "torques are those of a servo, kp (q_cmd − q) − kd qd with kp {}, kd {}, qd {velocity}{delay}{guessed}",
        listed(&servo.kp),
        listed(&servo.kd)
    )
}

/// Kp (q_cmd(t − d) − q − offset), N·m (N), N × n. Between two rows a delayed command is on the line between them; NaN before there is
/// one. `offset` is what is still to be added to the positions, rad (m), n; none where nothing is.
pub(super) fn stiffness_torque(
    servo: &PositionServo,
    command: &[f64],
    q: &[f64],
    offset: &[f64],
    t: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let n = servo.kp.len();
    let rows = q.len() / n;
    let mut from = 0;
    let mut torque = Vec::with_capacity(q.len());
    for row in 0..rows {
        let at = t(row) - servo.delay_s;
        while from + 1 < rows && t(from + 1) <= at {
            from += 1;
        }
        let after = (from + 1).min(rows - 1);
        let (before, next) = (t(from), t(after));
        let weight = if servo.delay_s == 0.0 || next <= before { 0.0 } else { (at - before) / (next - before) };
        let from = if servo.delay_s == 0.0 { row } else { from };
        for (joint, kp) in servo.kp.iter().enumerate() {
            let known = |row: usize| command[row * n + joint];
            let commanded = match weight {
                0.0 => known(from),
                weight if weight < 0.0 => f64::NAN,
                weight => known(from) + weight * (known(after) - known(from)),
            };
            let reached = q[row * n + joint] + offset.get(joint).copied().unwrap_or(0.0);
            torque.push(kp * (commanded - reached));
        }
    }
    torque
}

/// Velocities of rows at a constant rate, rad/s (m/s), N × n, by differences that are exact for polynomials of the fourth degree, and of the
/// second in the two rows at each end.
pub(super) fn velocities(q: &[f64], n: usize, rate_hz: f64) -> Vec<f64> {
    let rows = q.len() / n.max(1);
    let mut velocities = Vec::with_capacity(q.len());
    for row in 0..rows {
        for joint in 0..n {
            let x = |row: usize| q[row * n + joint];
            let slope = match (row, rows - 1 - row) {
                (2.., 2..) => (8.0 * (x(row + 1) - x(row - 1)) - (x(row + 2) - x(row - 2))) / 12.0,
                (1.., 1..) => 0.5 * (x(row + 1) - x(row - 1)),
                (0, 2..) => 0.5 * (4.0 * x(1) - 3.0 * x(0) - x(2)),
                (2.., 0) => 0.5 * (3.0 * x(row) - 4.0 * x(row - 1) + x(row - 2)),
                (0, 1) | (1, 0) => x(1) - x(0),
                _ => 0.0,
            };
            velocities.push(slope * rate_hz);
        }
    }
    velocities
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_torque_of_a_ramp_is_stiffness_times_its_lag() {
        let t = |row: usize| 0.01 * row as f64;
        let rows = 20;
        let command: Vec<f64> = (0..rows).flat_map(|row| [t(row), 2.0 - 3.0 * t(row)]).collect();
        let q = vec![0.5; 2 * rows];
        for (delay_s, late) in [(0.0, 0), (0.025, 3)] {
            let servo = PositionServo::new(vec![10.0, 20.0], vec![0.0; 2], delay_s);
            let torque = stiffness_torque(&servo, &command, &q, &[0.0, 0.1], t);
            for row in 0..rows {
                let at = t(row) - delay_s;
                let expected = [10.0 * (at - 0.5), 20.0 * (2.0 - 3.0 * at - 0.6)];
                for (joint, expected) in expected.into_iter().enumerate() {
                    let found = torque[2 * row + joint];
                    let is_right = if row < late { found.is_nan() } else { (found - expected).abs() < 1e-12 };
                    assert!(is_right, "row {row}, joint {joint}: {found}, expected {expected}");
                }
            }
        }
    }

    #[test]
    fn analytic_velocities_of_a_quartic_and_a_parabola_are_exact() {
        let q: Vec<f64> = (0..8).map(|row| 0.1 * f64::from(row)).flat_map(|t| [t.powi(4), t * t]).collect();
        let found = velocities(&q, 2, 10.0);
        for row in 0..8 {
            let t = 0.1 * row as f64;
            assert!((found[2 * row + 1] - 2.0 * t).abs() < 1e-12);
            assert!(!(2..6).contains(&row) || (found[2 * row] - 4.0 * t.powi(3)).abs() < 1e-12);
        }
        assert_eq!(velocities(&[1.0, 2.0], 1, 10.0), [10.0, 10.0]);
    }
}
