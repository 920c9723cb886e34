//! The vendor's joint controller: one PID per motor, blind to the arm's dynamics.
//!
//! ```text
//! e = r − q̂        u = Kp e + I + Kd F(ė)        İ = Ki e
//! ω = 2π bandwidth      Kp = J ω²      Kd = 2 ζ ω J      Ki = Kp · 2π integral
//! ```
//! `J` is the nominal inertia that the motor sees, `F` a first-order low-pass at ten times the bandwidth, and `ė` the
//! difference of the error from step to step, so that the derivative sees what the encoder resolves. The first step
//! takes its own error for the one before: no kick. The integral rests while the current is at its limit and the
//! error pushes further: no wind-up.
//!
//! A tuning with `friction` raises Kp and Kd by the nominal friction, as [`ServoTuning`] says.
//!
//! There is no feed-forward, as in the plainest vendor controllers: a motion of angular frequency `w ≪ ω` under a
//! torque `τ` is followed with an error of about `(τ − J q̈) / Kp`, less what the integral takes.

use super::motor_load::MotorLoad;
use crate::lanes::Lane;
use crate::model::ServoTuning;

/// Highest natural frequency of the derivative over the rate of the servo, rad.
const FASTEST: f64 = 0.3;

/// The controller of one motor, and its current limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorPid {
    pub(super) kp: f64,
    pub(super) kd: f64,
    pub(super) ki: f64,
    /// Ampere per unit of torque.
    pub(super) ampere: f64,
    limit: f64,
    pub(super) smoothing: f64,
    pub(super) dt: f64,
    pub(super) rate_hz: f64,
}

/// What a controller remembers of a motor from step to step: error (rad), its filtered rate (rad/s), integral (N·m).
#[derive(Clone, Copy, Debug)]
pub(super) struct PidMemory<V> {
    pub(super) last_error: V,
    pub(super) rate: V,
    pub(super) integral: V,
}

/// What a controller decides: a current (A); 1 where it is at its limit, else 0; 1 where the integral rests, else 0.
pub(super) struct Decision<V> {
    pub(super) current: V,
    held: V,
    rested: V,
}

impl MotorPid {
    /// One step of one motor, of a run or of several; the `fresh` one has no error before it.
    #[inline(always)]
    pub(super) fn step<V: Lane>(&self, memory: &mut PidMemory<V>, command: V, measured: V, fresh: bool) -> Decision<V> {
        let (zero, one, limit) = (command.splat(0.0), command.splat(1.0), command.splat(self.limit));
        let error = command - measured;
        let difference = if fresh { zero } else { (error - memory.last_error) * command.splat(self.rate_hz) };
        memory.last_error = error;
        memory.rate = memory.rate + command.splat(self.smoothing) * (difference - memory.rate);
        let wanted = (command.splat(self.kp) * error + command.splat(self.kd) * memory.rate + memory.integral)
            * command.splat(self.ampere);
        let held = limit.less(wanted.magnitude(), one, zero);
        let rested = zero.less(wanted * error, held, zero);
        memory.integral = zero.less(
            rested,
            memory.integral,
            memory.integral + command.splat(self.ki) * error * command.splat(self.dt),
        );
        let current = wanted.less(-limit, -limit, wanted);
        Decision { current: limit.less(current, limit, current), held, rested }
    }
}

/// The controllers of all motors, in motor coordinates after the gear.
#[derive(Clone, Debug)]
pub struct JointPid {
    pub(super) motors: Vec<MotorPid>,
    memory: Vec<PidMemory<f64>>,
    /// Whether the last step left a current at its limit, and the integral as it was.
    pub(super) held: Vec<bool>,
    pub(super) rested: Vec<bool>,
    dt: f64,
    fresh: bool,
}

impl JointPid {
    /// Gains for motors that turn this load and give `per_ampere` (N·m/A) up to `limit` (A).
    pub fn new(tuning: &ServoTuning, load: &MotorLoad, per_ampere: &[f64], limit: &[f64]) -> Self {
        let n = load.inertia.len();
        let base = std::f64::consts::TAU * tuning.bandwidth_hz;
        let dt = 1.0 / tuning.rate_hz;
        let on_inertia = load.inertia.iter().map(|j| j * base * base);
        // Position gain and natural frequency of each motor.
        let (kp, omega): (Vec<f64>, Vec<f64>) = if tuning.friction {
            let fastest = base.max(FASTEST * tuning.rate_hz);
            on_inertia
                .enumerate()
                .map(|(i, kp)| {
                    let j = load.inertia[i];
                    let coulomb = (load.coulomb_per_speed[i] * base).min(j * (fastest * fastest - base * base));
                    let kp = kp + load.viscous[i] * base + coulomb;
                    (kp, (kp / j).sqrt().min(fastest))
                })
                .unzip()
        } else {
            on_inertia.map(|kp| (kp, base)).unzip()
        };
        let motor = |i: usize| MotorPid {
            kp: kp[i],
            kd: 2.0 * tuning.damping * omega[i] * load.inertia[i],
            ki: kp[i] * std::f64::consts::TAU * tuning.integral_hz,
            ampere: 1.0 / per_ampere[i],
            limit: limit[i],
            smoothing: 1.0 - libm::exp(-10.0 * omega[i] * dt),
            dt,
            rate_hz: tuning.rate_hz,
        };
        Self {
            motors: (0..n).map(motor).collect(),
            memory: vec![PidMemory { last_error: 0.0, rate: 0.0, integral: 0.0 }; n],
            held: vec![false; n],
            rested: vec![false; n],
            dt,
            fresh: true,
        }
    }

    /// Length of a servo step, s.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Resets everything but the gains.
    pub fn reset(&mut self) {
        for memory in &mut self.memory {
            (memory.integral, memory.rate) = (0.0, 0.0);
        }
        self.fresh = true;
    }

    /// What is remembered from step to step: last errors, their filtered rates, integrals; 3n.
    pub(super) fn memory(&self) -> Vec<f64> {
        let of: [fn(&PidMemory<f64>) -> f64; 3] = [|m| m.last_error, |m| m.rate, |m| m.integral];
        of.iter().flat_map(|of| self.memory.iter().map(of)).collect()
    }

    /// Goes on from what was remembered elsewhere, as [`JointPid::memory`] gives it.
    pub(super) fn recall(&mut self, memory: &[f64]) {
        let n = self.memory.len();
        for (i, own) in self.memory.iter_mut().enumerate() {
            *own = PidMemory { last_error: memory[i], rate: memory[n + i], integral: memory[2 * n + i] };
        }
        self.fresh = false;
    }

    /// Adds these motor torques to the integrals, N·m; n.
    pub(super) fn add_to_integrals(&mut self, torque: &[f64]) {
        for (memory, torque) in self.memory.iter_mut().zip(torque) {
            memory.integral += torque;
        }
    }

    /// One servo step: commanded and measured motor coordinates (rad) in, motor currents (A) out, n each. Returns
    /// whether a current is at its limit.
    pub fn step(&mut self, command: &[f64], measured: &[f64], current: &mut [f64]) -> bool {
        let (n, mut saturated) = (current.len(), false);
        // Of one known length, so that no entry is checked by itself.
        let [command, measured] = [command, measured].map(|x| &x[..n]);
        let (motors, memory) = (&self.motors[..n], &mut self.memory[..n]);
        let [was_held, rested] = [&mut self.held, &mut self.rested].map(|x| &mut x[..n]);
        for i in 0..n {
            let decision = motors[i].step(&mut memory[i], command[i], measured[i], self.fresh);
            current[i] = decision.current;
            was_held[i] = decision.held > 0.0;
            rested[i] = decision.rested > 0.0;
            saturated |= was_held[i];
        }
        self.fresh = false;
        saturated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pid(limit: f64) -> JointPid {
        JointPid::new(&ServoTuning::ASSUMED, &load(2.0, 0.0, 0.0), &[15.0], &[limit])
    }

    fn load(inertia: f64, viscous: f64, coulomb_per_speed: f64) -> MotorLoad {
        MotorLoad { inertia: vec![inertia], viscous: vec![viscous], coulomb_per_speed: vec![coulomb_per_speed] }
    }

    #[test]
    fn analytic_gains_with_friction_are_those_of_the_documented_formula() {
        let tuning = |friction| ServoTuning { friction, ..ServoTuning::ASSUMED };
        let omega = std::f64::consts::TAU * 8.0;
        let of = |friction, load: &MotorLoad| {
            let pid = JointPid::new(&tuning(friction), load, &[15.0], &[1e9]);
            (pid.motors[0].kp, pid.motors[0].kd, pid.motors[0].smoothing)
        };
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        // Without friction nothing changes.
        let (with, without) = (of(true, &load(2.0, 0.0, 0.0)), of(false, &load(2.0, 3.0, 4.0)));
        close(with.0, without.0);
        close(with.1, without.1);
        close(with.2, without.2);
        // A wrist of 2e-4 kg·m² with 10 N·m·s/rad: the derivative ends at 300 rad/s of a servo at 1 kHz.
        let (kp, kd, _) = of(true, &load(2e-4, 10.0, 0.0));
        close(kp, 2e-4 * omega * omega + 10.0 * omega);
        close(kd, 2.0 * 0.8 * 300.0 * 2e-4);
        // Coulomb friction, below that bound and at it.
        let (kp, kd, _) = of(true, &load(0.1, 0.0, 1.0));
        close(kp, 0.1 * omega * omega + omega);
        close(kd, 2.0 * 0.8 * 0.1 * (kp / 0.1).sqrt());
        close(of(true, &load(1e-4, 0.0, 5.0)).0, 1e-4 * 300.0 * 300.0);
    }

    #[test]
    fn analytic_first_step_has_no_derivative_kick() {
        let mut pid = pid(1e9);
        let mut current = [0.0];
        pid.step(&[0.1], &[0.0], &mut current);
        let omega = std::f64::consts::TAU * 8.0;
        // Proportional part alone: J ω² e / (N Kt); rounding of five products.
        assert!((current[0] - 2.0 * omega * omega * 0.1 / 15.0).abs() < 1e-12 * current[0]);
    }

    #[test]
    fn analytic_current_stays_at_its_limit_and_leaves_it_at_once() {
        let mut pid = pid(1.0);
        let mut current = [0.0];
        for _ in 0..10_000 {
            assert!(pid.step(&[1.0], &[0.0], &mut current));
            assert!((current[0] - 1.0).abs() < 1e-15);
        }
        // Ten seconds at the limit have not wound the integral up: a reversed error of the same size reverses the
        // current in one step.
        pid.step(&[-1.0], &[0.0], &mut current);
        assert!((current[0] + 1.0).abs() < 1e-15);
    }

    #[test]
    fn analytic_integral_grows_at_its_rate() {
        let mut pid = pid(1e9);
        let mut current = [0.0];
        let omega = std::f64::consts::TAU * 8.0;
        let kp = 2.0 * omega * omega;
        for _ in 0..1001 {
            pid.step(&[1e-3], &[0.0], &mut current);
        }
        // 1000 steps of 1 ms with Ki = Kp 2π 0.5 Hz.
        let expected = kp * 1e-3 * (1.0 + std::f64::consts::TAU * 0.5) / 15.0;
        assert!((current[0] - expected).abs() < 1e-11 * expected);
    }
}
