//! What links that follow their motors unevenly ask of them.
//!
//! ```text
//! C q = P(C x),  P_i(θ_i) = θ_i + ε_i(θ_i)        x the coordinates of the plant, C x those of the motors
//! C q̇ = (1 + ε′) C ẋ        C q̈ = (1 + ε′) C ẍ + ε″ (C ẋ)²
//! τ_x = Cᵀ (1 + ε′) C⁻ᵀ τ_l(q, q̇, q̈)        of the plant's τ_l(x, ẋ, ẍ) the servo takes what is too much or too little
//! ```
//! Lagrange's equations in the motors' coordinates: links of the kinetic energy `T(P(θ), Ṗ)` on rotors of `½ J θ̇²`. `τ_l` is what
//! the links take, by Newton–Euler, at the middle of a part of a servo step; `ẍ` there follows from its means over the last two
//! parts by a line, as far as that feedback, of gain `(1 + ε′)² − 1`, stays stable.

use super::transmission_error::{Lead, TransmissionError};
use crate::dynamics::Dynamics;
use crate::experiment::transmission::Transmission;

/// Largest gain of the feedback of accelerations.
const GAIN: f64 = 0.8;

/// Links behind motors with errors.
#[derive(Clone, Debug)]
pub(super) struct UnevenLinks {
    errors: Vec<TransmissionError>,
    leads: Vec<Lead>,
    /// How far the line through the last two accelerations is followed, in steps of one part; at most one.
    ahead: f64,
    /// Acceleration of the part before the last.
    before: Option<Vec<f64>>,
    motor: Vec<f64>,
    rate: Vec<f64>,
    joint: Vec<f64>,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

impl UnevenLinks {
    /// Behind motors with these errors; none where a spring takes the error.
    pub(super) fn new(errors: Vec<TransmissionError>) -> Self {
        let n = errors.len();
        let zero = || vec![0.0; n];
        // The feedback x_k = g ((1 + a) x_{k−1} − a x_{k−2}) is stable where g (1 + 2 a) < 1.
        let steepest = 1.0 + errors.iter().map(TransmissionError::steepest).fold(0.0, f64::max);
        let gain = steepest * steepest - 1.0;
        let ahead = if gain > 0.0 { (0.5 * (GAIN / gain - 1.0)).clamp(0.0, 1.0) } else { 1.0 };
        Self {
            errors,
            leads: vec![Lead::default(); n],
            ahead,
            before: None,
            motor: zero(),
            rate: zero(),
            joint: zero(),
            q: zero(),
            qd: zero(),
            qdd: zero(),
        }
    }

    /// Finds what the links take, N·m, at the middle of a part of `h` s that the plant begins at `q`, `qd`, after one of the
    /// mean acceleration `qdd`; `extra` becomes the torque on the joints of the plant that makes up for the errors.
    pub(super) fn load(
        &mut self,
        links: &mut Dynamics,
        transmission: &Transmission,
        [q, qd, qdd]: [&[f64]; 3],
        h: f64,
        load: &mut [f64],
        extra: &mut [f64],
    ) {
        let n = q.len();
        let before = self.before.get_or_insert_with(|| qdd.to_vec());
        for i in 0..n {
            self.qdd[i] = qdd[i] + self.ahead * (qdd[i] - before[i]);
            self.q[i] = q[i] + 0.5 * h * qd[i];
            self.qd[i] = qd[i] + 0.5 * h * self.qdd[i];
        }
        before.copy_from_slice(qdd);
        links.inverse(&self.q, &self.qd, &self.qdd, extra);
        transmission.motor_motion(&self.qd, &mut self.rate);
        // Positions, velocities and accelerations in turn, each by what the motors lead and lag.
        transmission.motor_motion(&self.q, &mut self.motor);
        for i in 0..n {
            self.leads[i] = self.errors[i].lead(self.motor[i]);
            self.motor[i] = self.leads[i].angle;
        }
        transmission.joint_motion(&self.motor, &mut self.joint);
        add(&self.joint, &mut self.q);
        transmission.motor_motion(&self.qdd, &mut self.motor);
        for i in 0..n {
            let Lead { slope, curvature, .. } = self.leads[i];
            self.motor[i] = slope * self.motor[i] + curvature * self.rate[i] * self.rate[i];
        }
        transmission.joint_motion(&self.motor, &mut self.joint);
        add(&self.joint, &mut self.qdd);
        for i in 0..n {
            self.motor[i] = self.leads[i].slope * self.rate[i];
        }
        transmission.joint_motion(&self.motor, &mut self.joint);
        add(&self.joint, &mut self.qd);
        links.inverse(&self.q, &self.qd, &self.qdd, load);
        transmission.motor_torque(load, &mut self.motor);
        for i in 0..n {
            self.motor[i] *= 1.0 + self.leads[i].slope;
        }
        transmission.joint_torque(&self.motor, &mut self.joint);
        for i in 0..n {
            extra[i] -= self.joint[i];
        }
    }
}

fn add(change: &[f64], to: &mut [f64]) {
    for (value, change) in to.iter_mut().zip(change) {
        *value += change;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::ChainRecipe;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ActualArm, EffectKind, Effects, Plant};
    use crate::model::StandardParameters;
    use crate::model::term::ROTOR;
    use crate::seed::Seed;
    use crate::spatial::Inertia;

    use super::super::ActualDrives;

    /// A path of the plant's coordinates, and where the links are on it, by differences of the position alone.
    #[test]
    fn identity_links_move_as_their_positions_do_and_power_is_the_same_on_both_sides() {
        let mut rng = Seed::new(12).stream("chains", 0);
        for coupled in [false, true] {
            let (robot, parameters) = ChainRecipe { coupled, ..ChainRecipe::new(3) }.draw(&mut rng);
            let mut links = Dynamics::new(&robot, &parameters.links_alone());
            let transmission = Transmission::new(&robot);
            let errors = TransmissionError::of_motors(&[(30.0, true), (40.0, true), (20.0, true)], 1e-3, Seed::new(3));
            let plant = |t: f64| [0.3 + 0.4 * libm::sin(t), 0.2 * libm::cos(1.3 * t), 0.5 * libm::sin(0.7 * t + 0.2)];
            let places = |t: f64| {
                let (mut motor, mut q) = ([0.0; 3], [0.0; 3]);
                transmission.motor_motion(&plant(t), &mut motor);
                for i in 0..3 {
                    motor[i] += errors[i].lead(motor[i]).angle;
                }
                transmission.joint_motion(&motor, &mut q);
                q
            };
            let rates = |path: &dyn Fn(f64) -> [f64; 3], t: f64| {
                // Fourth-order differences.
                let h = 1e-3;
                let at = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| path(t + k * h));
                let first = |i: usize| (at[0][i] - 8.0 * at[1][i] + 8.0 * at[3][i] - at[4][i]) / (12.0 * h);
                let second =
                    |i: usize| (16.0 * (at[1][i] + at[3][i]) - at[0][i] - at[4][i] - 30.0 * at[2][i]) / (12.0 * h * h);
                [std::array::from_fn::<f64, 3, _>(first), std::array::from_fn(second)]
            };
            for k in 0..20 {
                let t = 0.31 * f64::from(k);
                let [xd, xdd] = rates(&plant, t);
                let [qd, qdd] = rates(&places, t);
                let (mut load, mut extra, mut expected) = ([0.0; 3], [0.0; 3], [0.0; 3]);
                links.inverse(&plant(t), &xd, &xdd, &mut load);
                let without = load;
                let mut uneven = UnevenLinks::new(errors.clone());
                uneven.load(&mut links, &transmission, [&plant(t), &xd, &xdd], 0.0, &mut load, &mut extra);
                links.inverse(&places(t), &qd, &qdd, &mut expected);
                let size = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
                let on_plant: [f64; 3] = std::array::from_fn(|i| without[i] - extra[i]);
                for i in 0..3 {
                    // What differences leave of the sixth derivative: (2 N q̇)⁴ h⁴ of some hundredths.
                    assert!((load[i] - expected[i]).abs() < 1e-4 * size, "{load:?} {expected:?}");
                }
                assert!((dot(&on_plant, &xd) - dot(&load, &qd)).abs() < 1e-6 * size, "{on_plant:?} {load:?}");
                assert!((0..3).any(|i| extra[i].abs() > 1e-3 * size), "{extra:?}");
            }
        }
    }

    /// A motor of constant torque turns a link of 1.5 kg·m² on a rotor of 0.5: its work is their kinetic energy, as fast as the link is.
    #[test]
    fn analytic_work_of_the_motor_is_the_energy_of_rotor_and_link() {
        let robot = hinges::single();
        let mut truth = StandardParameters::zero(1);
        let mut rotational = nalgebra::Matrix3::zeros();
        rotational[(2, 2)] = hinges::INERTIA - 0.5;
        truth.links[0] = Inertia { rotational, ..Inertia::zero() };
        truth.drives[0][ROTOR] = 0.5;
        let effects = Effects::none().with_effect(EffectKind::TransmissionError, 0.5).with_seed(Seed::new(2));
        let arm = ActualArm::new(&effects, &robot, &truth);
        let error = arm.transmission_errors()[0];
        let (transmission, start) = (Transmission::new(&robot), 0.3);
        let mut drives = ActualDrives::of(&arm, &transmission, &transmission.per_ampere, &[start]).unwrap();
        let mut plant = FlyWheels::new(1);
        plant.reset(&[start], &[0.0]);
        let current = 0.1;
        let h = 1.0 / (robot.servo().rate_hz * drives.parts as f64);
        let (mut apart, mut swing) = (0.0_f64, 0.0_f64);
        for _ in 0..1500 {
            drives.set(&[current]);
            for _ in 0..drives.parts {
                let (q, qd) = plant.state();
                let mut tau = [0.0];
                drives.push(q, qd, &mut tau);
                plant.step(&tau, h).unwrap();
            }
            let (q, qd) = (plant.state().0[0], plant.state().1[0]);
            let lead = error.lead(q);
            let link = (1.0 + lead.slope) * qd;
            let energy = 0.5 * 0.5 * qd * qd + 0.5 * 1.5 * link * link;
            let work = transmission.per_ampere[0] * current * (q - start);
            apart = apart.max((energy - work).abs());
            swing = swing.max((energy - 0.5 * hinges::INERTIA * qd * qd).abs());
        }
        // What the line through two accelerations leaves is of second order in 2 N θ̇ h, 0.06 at the end.
        assert!(swing > 0.1 && apart < 4e-3 * swing, "{apart:e} of {swing:e}");
    }
}
