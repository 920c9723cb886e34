//! How the servo's torque moves with the motion that it follows: derivatives of [`JointLoop`] by any parameters.
//!
//! ```text
//! e' = −C q'        u' = Kp e' + I' + Kd F(ė')        I' ← I' + Ki e' dt        i' = u'/(N Kt)        τ' = Cᵀ N Kt i'
//! ```
//! A current at its limit does not move, one at the limit of its supply moves with the speed of its motor, and the integral of a
//! controller that rests does neither. Encoders are taken as exact.

use super::joint_loop::JointLoop;

/// Derivatives of a loop's state by d parameters, one row of d for each joint or motor. Goes beside a [`JointLoop`], step by step.
#[derive(Clone, Debug)]
pub struct LoopSlopes {
    directions: usize,
    fresh: bool,
    last_error: Vec<f64>,
    rate: Vec<f64>,
    integral: Vec<f64>,
    motor: Vec<f64>,
    tau: Vec<f64>,
}

impl LoopSlopes {
    /// The slopes of `joints` joints by so many parameters, on none of which the loop depends yet.
    pub fn new(joints: usize, directions: usize) -> Self {
        let zero = || vec![0.0; joints * directions];
        Self { directions, fresh: true, last_error: zero(), rate: zero(), integral: zero(), motor: zero(), tau: zero() }
    }

    /// Derivatives of [`JointLoop::memory`], 3n × d by rows.
    pub fn memory(&self) -> Vec<f64> {
        [&self.last_error[..], &self.rate, &self.integral].concat()
    }

    /// Continues where [`JointLoop::recall`] does, with these derivatives of that memory (3n × d by rows).
    ///
    /// # Panics
    /// If they are of another number of joints or parameters.
    pub fn recall(&mut self, memory: &[f64]) {
        let size = self.tau.len();
        assert_eq!(memory.len(), 3 * size, "three rows for each motor");
        self.last_error.copy_from_slice(&memory[..size]);
        self.rate.copy_from_slice(&memory[size..2 * size]);
        self.integral.copy_from_slice(&memory[2 * size..]);
        self.fresh = false;
    }

    /// Follows the step that `joints` has just taken; `q` and `qd` are the derivatives of joint coordinates and velocities at
    /// that step, n × d.
    pub fn step(&mut self, joints: &JointLoop, q: &[f64], qd: &[f64]) {
        let d = self.directions;
        let fresh = std::mem::take(&mut self.fresh);
        let (pid, motors) = (&joints.controller, &joints.motors);
        let forward = joints.transmission.forward.as_ref();
        let n = pid.motors.len();
        for i in 0..n {
            let motor = &pid.motors[i];
            let at = i * d..(i + 1) * d;
            let own = &mut self.motor[at.clone()];
            match forward {
                None => own.copy_from_slice(&q[at.clone()]),
                Some(c) => combine(own, q, |j| c[(i, j)]),
            }
            let rows = own
                .iter_mut()
                .zip(&mut self.last_error[at.clone()])
                .zip(&mut self.rate[at.clone()])
                .zip(&mut self.integral[at.clone()]);
            for (((own, last), rate), integral) in rows {
                let error = -*own;
                let difference = if fresh { 0.0 } else { (error - *last) * motor.rate_hz };
                *last = error;
                *rate += motor.smoothing * (difference - *rate);
                let wanted = (motor.kp * error + motor.kd * *rate + *integral) * motor.ampere;
                *own = if pid.held[i] { 0.0 } else { wanted };
                if !pid.rested[i] {
                    *integral += motor.ki * error * motor.dt;
                }
            }
            if let Some(slope) = motors.supply_slope(i, joints.qd_motor[i], joints.current[i]) {
                match forward {
                    None => own.copy_from_slice(&qd[at]),
                    Some(c) => combine(own, qd, |j| c[(i, j)]),
                }
                own.iter_mut().for_each(|own| *own *= slope);
            }
            own.iter_mut().for_each(|own| *own *= motors.per_ampere[i]);
        }
        match forward {
            None => self.tau.copy_from_slice(&self.motor),
            Some(c) => {
                for i in 0..n {
                    combine(&mut self.tau[i * d..(i + 1) * d], &self.motor, |j| c[(j, i)]);
                }
            }
        }
    }

    /// Derivatives of [`JointLoop::tau`], n × d.
    pub fn tau(&self) -> &[f64] {
        &self.tau
    }
}

/// `Σ_j c_j row_j` of a table of rows as long as `out`.
fn combine(out: &mut [f64], rows: &[f64], c: impl Fn(usize) -> f64) {
    out.fill(0.0);
    for (j, row) in rows.chunks_exact(out.len()).enumerate() {
        let c = c(j);
        for (out, x) in out.iter_mut().zip(row) {
            *out += c * x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Sensing, hinges};
    use crate::model::{Drive, MotorCircuit, Robot};
    use crate::seed::Seed;

    /// Torques of 40 steps along positions that move with one parameter p, and their derivative at p = 0.
    fn torques(robot: &Robot, p: f64) -> (Vec<f64>, Vec<f64>) {
        let nominal = hinges::parameters(robot.dof());
        let mut joints = JointLoop::new(robot, &nominal, &Sensing::ideal(), Seed::new(0), 0).unwrap();
        let mut slopes = LoopSlopes::new(2, 1);
        let (mut tau, mut by) = (Vec::new(), Vec::new());
        for k in 0..40 {
            let t = f64::from(k);
            let along = [libm::sin(0.3 * t), 0.4 * libm::cos(0.2 * t)];
            let base = [0.3 * libm::sin(0.1 * t), -0.2 * libm::sin(0.15 * t)];
            let q = [base[0] + p * along[0], base[1] + p * along[1]];
            let qd = [20.0 * base[1] + p * along[1], 30.0 * base[0] - p * along[0]];
            joints.step(&[0.1, 0.05 * t], &q, &qd);
            slopes.step(&joints, &along, &[along[1], -along[0]]);
            tau.extend_from_slice(joints.tau());
            by.extend_from_slice(slopes.tau());
        }
        (tau, by)
    }

    fn check(robot: &Robot) {
        let h = 1e-7;
        let ((low, _), (high, _), (_, by)) = (torques(robot, -h), torques(robot, h), torques(robot, 0.0));
        let size = by.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(size > 1.0);
        for (k, by) in by.iter().enumerate() {
            let difference = (high[k] - low[k]) / (2.0 * h);
            // Rounding of torques of some thousand N·m over 2e-7.
            assert!((difference - by).abs() < 1e-6 * size.max(1e3), "{k}: {difference} {by}");
        }
    }

    #[test]
    fn analytic_slopes_are_central_differences_of_the_loop() {
        let limited = |limit: f64, supply: f64| {
            let robot = hinges::coupled();
            let circuit = MotorCircuit { resistance: 1.5, inductance: 1.5e-3, back_emf: 0.15, brush_drop: 1.0, supply };
            let drive = |drive: &Drive| Drive { current_limit: limit, circuit: Some(circuit), ..drive.clone() };
            let drives = robot.joints().iter().map(|joint| drive(&joint.drive)).collect();
            robot.with_drives(drives)
        };
        let free = limited(1e9, f64::INFINITY);
        check(&free);
        // Currents at their limits half of the time, and supplies that let no more through.
        let per_ampere = free.joints()[0].drive.torque_per_ampere();
        let mut currents: Vec<f64> = torques(&free, 0.0).0.iter().map(|tau| tau.abs() / per_ampere).collect();
        currents.sort_by(f64::total_cmp);
        // Not at one of them, where the loop has a corner.
        let half = 1.001 * currents[currents.len() / 2];
        check(&limited(half, f64::INFINITY));
        check(&limited(1e9, 1.5 * half));
    }
}
