//! From values at the motors to values at the joints, once the robot is known.
//!
//! ```text
//! C q = q_motor / N        τ = Cᵀ N τ_motor        q += offset
//! ```
//! with the robot's coupling C (one where its motors are not coupled) and the gear ratios N: those of the mapping, which
//! have been applied already, or else the robot's.

use armid::model::Robot;
use nalgebra::{DMatrix, DVector};

use super::conversion::AtMotors;
use super::joint_log::Log;
use crate::error::Error;

impl Log {
    /// Brings the values to the joints, which are those of the robot.
    ///
    /// # Errors
    /// [`Error`] where a gear ratio is needed that the robot does not have.
    pub(super) fn bring_to_joints(&mut self, robot: &Robot) -> Result<(), Error> {
        let n = robot.dof();
        let conversion = std::mem::take(&mut self.conversion);
        let gears: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.gear).collect();
        let known = |at: AtMotors, what: &str| -> Result<Vec<f64>, Error> {
            match at {
                AtMotors::Geared => Ok(vec![1.0; n]),
                AtMotors::RobotsGear if gears.iter().any(|gear| *gear != 1.0) => Ok(gears.clone()),
                AtMotors::RobotsGear => {
                    let message = format!(
                        "{}: {what} are those of the motors, and robot \"{}\" has no gear ratios",
                        self.name,
                        robot.name()
                    );
                    Err(Error::new(message).help("state them: motor gear=100/100/50"))
                }
            }
        };
        let coupling = robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
        let to_joints = |gears: &[f64]| -> Result<DMatrix<f64>, Error> {
            let inverse = coupling.clone().try_inverse();
            let inverse =
                inverse.ok_or_else(|| Error::new(format!("the coupling of robot \"{}\" is singular", robot.name())))?;
            Ok(inverse * DMatrix::from_diagonal(&DVector::from_iterator(n, gears.iter().map(|gear| gear.recip()))))
        };
        if let Some(at) = conversion.q {
            self.q = mapped(&self.q, &to_joints(&known(at, "positions")?)?);
        }
        if let (Some(at), Some(qd)) = (conversion.qd, &mut self.qd) {
            *qd = mapped(qd, &to_joints(&known(at, "velocities")?)?);
        }
        if let Some(at) = conversion.effort {
            let gears = known(at, "torques")?;
            let map = coupling.transpose() * DMatrix::from_diagonal(&DVector::from_vec(gears));
            self.effort = mapped(&self.effort, &map);
            self.exclude_coupled(robot);
        }
        if !conversion.offset.is_empty() {
            for row in self.q.chunks_exact_mut(n) {
                for (q, offset) in row.iter_mut().zip(&conversion.offset) {
                    *q += offset;
                }
            }
        }
        Ok(())
    }

    /// Leaves out the torque of a joint to which a motor adds whose effort is left out, of efforts that are those of motors.
    pub(super) fn exclude_coupled(&mut self, robot: &Robot) {
        let Some(coupling) = robot.coupling() else { return };
        for row in self.excluded.chunks_exact_mut(robot.dof()) {
            let motors = row.to_vec();
            for (joint, excluded) in row.iter_mut().enumerate() {
                *excluded |= motors.iter().enumerate().any(|(motor, out)| *out && coupling[(motor, joint)] != 0.0);
            }
        }
    }
}

/// The map applied to every row.
fn mapped(rows: &[f64], map: &DMatrix<f64>) -> Vec<f64> {
    let n = map.nrows();
    rows.chunks_exact(n)
        .flat_map(|row| (0..n).map(move |i| row.iter().enumerate().map(|(j, x)| map[(i, j)] * x).sum::<f64>()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::conversion::{AtMotors, Conversion};
    use crate::robot;
    use crate::text::Text;

    #[test]
    fn identity_power_at_the_motors_is_power_at_the_joints_of_a_coupled_wrist() {
        let robot = robot::find("staubli-tx40").unwrap().robot;
        let row = |x: f64| (1..=6).map(|k| (x * f64::from(k)).to_string()).collect::<Vec<_>>().join(",");
        let names = |prefix: &str| (1..=6).map(|k| format!("{prefix}{k}")).collect::<Vec<_>>().join(",");
        let text = format!("t,{},{},{}\n", names("q"), names("qd"), names("tau"))
            + &(0..20).map(|k| format!("{k},{},{},{}\n", row(0.1), row(0.2), row(0.3))).collect::<String>();
        let mut log = crate::log::parse_csv(Text::new("r.csv", text)).unwrap();
        let (_, motor_speed, motor_torque) = (log.q.clone(), log.qd.clone().unwrap(), log.effort.clone());
        log.conversion = Conversion {
            q: Some(AtMotors::RobotsGear),
            qd: Some(AtMotors::RobotsGear),
            effort: Some(AtMotors::RobotsGear),
            offset: vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        };
        log.excluded = vec![false; log.q.len()];
        log.excluded[5] = true;
        log.bring_to_joints(&robot).unwrap();
        // Its torque is part of that of joint 5.
        assert_eq!(log.excluded[..7], [false, false, false, false, true, true, false]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).take(6).map(|(a, b)| a * b).sum::<f64>();
        let at_motors = dot(&motor_speed, &motor_torque);
        assert!((dot(&log.qd.clone().unwrap(), &log.effort) - at_motors).abs() < 1e-12 * at_motors.abs());
        // Motor 6 turns with joints 5 and 6: q_motor6 = 32 (q5 + q6).
        assert!((log.q[5] - 1.0 - (0.6 / 32.0 - 0.5 / 45.0)).abs() < 1e-12);
    }
}
