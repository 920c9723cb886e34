//! The spring between a motor and its link, and which drives it makes two masses of.
//!
//! ```text
//! J θ̈ = τ_m − f(θ̇) − τ_s        M_l(q) q̈ + c + g = Cᵀ τ_s        τ_s = k u(δ) + Σ s_j + d δ̇        δ = θ − C q
//! k = τ_max / wind-up at the rating        d = 2 ζ √(k J_r), ζ = 0.05, J_r = 1/(1/J + m)
//! ```
//! `θ` is the motor after its gear, `m` the mobility of the links there (diagonal of `C M_l⁻¹ Cᵀ` at the gain pose), `u`
//! the gap ([`backlash`](super::backlash)), `s_j` the slip elements ([`hysteresis`](super::hysteresis)).
//!
//! With a spring, **rotor inertia and the friction of the drive belong to the motor**: the plant has the links alone. The
//! identification model still sees one mass: its columns `Ia`, `Fv` and `Fc` are those of the motor's motion as the
//! encoder on the motor shows it, and link inertia and gravity act through the spring.
//!
//! A link that is so light that `ω h > 0.25`, with `ω = √(k (1/J + m))` and h the part of a servo step, moves with its
//! motor for all the servo sees. There the drive stays whole in the plant, and the encoder's angle is quasi-static:
//! `θ = C q + δ(τ_t)`, `τ_t` the torque that the links take. On the A460 these are joints of the wrist.
//!
//! A step of the two masses holds the spring's torque at mid-step, `δ + h/2 δ̇`: with it the pair of plant and
//! motor is a leapfrog, which neither feeds nor damps an undamped oscillation; its frequency is right to (ωh)²/24.
//!
//! An [error of the gear](super::transmission_error) ε winds the spring beside them, `δ = θ + ε(θ) − C q`, and the rotor has `(1 + ε′) τ_s`.
//!
//! Sources: M. W. Spong, *J. Dyn. Syst. Meas. Control* 109(4), 1987 (the model); Harmonic Drive AG, HFUC catalogue, sizes
//! 14 to 25 with gear ratio 100: 1.3 to 2.5 mrad at the rated torque (K₁).

use super::backlash::{angle, contact};
use super::hysteresis::Slips;
use super::transmission_error::TransmissionError;

/// Damping ratio of the free oscillation.
const DAMPING: f64 = 0.05;
/// Largest `ω h` that is integrated.
const RESOLVED: f64 = 0.25;

/// The spring of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spring {
    pub(super) stiffness: f64,
    damping: f64,
    gap: f64,
    slips: Slips,
    /// Wind-up that the slip elements have come to.
    wound: f64,
}

impl Spring {
    /// A spring of `stiffness` N·m/rad with a gap and a loop of these widths, rad; without damping.
    pub(super) fn new(stiffness: f64, gap: f64, loop_width: f64) -> Self {
        Self { stiffness, damping: 0.0, gap, slips: Slips::new(stiffness, loop_width), wound: 0.0 }
    }

    /// Returns this joint between a rotor of inertia `rotor` and links of mobility `mobility` (1/(kg·m²)), damped as they oscillate.
    pub(super) fn between(mut self, rotor: f64, mobility: f64) -> Self {
        let inertia = 1.0 / (1.0 / rotor + mobility);
        self.damping = 2.0 * DAMPING * (self.stiffness * inertia).sqrt();
        self
    }

    /// Whether a step `h` (s) follows the oscillation of a rotor and links of this mobility.
    pub(super) fn is_followed(&self, rotor: f64, mobility: f64, h: f64) -> bool {
        rotor > 0.0 && (self.stiffness * (1.0 / rotor + mobility)).sqrt() * h <= RESOLVED
    }

    /// Torque at the angle `delta` of the motor before its link while it grows by `rate`; the state moves there.
    pub(super) fn torque(&mut self, delta: f64, rate: f64) -> f64 {
        let (u, slope) = contact(delta, self.gap);
        self.slips = self.slips.wound(u - self.wound);
        self.wound = u;
        self.stiffness * u + self.slips.torque() + self.damping * slope * rate
    }

    /// The angle of the motor before its link at rest under `torque`; the state moves there.
    pub(super) fn angle(&mut self, torque: f64) -> f64 {
        let now = self.stiffness * self.wound + self.slips.torque();
        let change = self.slips.change_for(self.stiffness, torque - now);
        self.slips = self.slips.wound(change);
        self.wound += change;
        angle(self.wound, self.gap)
    }
}

/// Motor and rotor on their side of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotorSide {
    pub(super) spring: Spring,
    rotor: f64,
    /// Steps of the rotor in a step of the spring: friction of a light rotor is stiff near standstill.
    parts: usize,
    error: TransmissionError,
    pub(super) q: f64,
    pub(super) qd: f64,
}

impl MotorSide {
    /// A rotor at rest at `q`, whose friction slopes by `slope` N·m·s/rad at most; for steps of `h` s.
    pub(super) fn new(spring: Spring, rotor: f64, slope: f64, h: f64, q: f64) -> Self {
        let parts = (slope / rotor * h / 0.5).ceil().clamp(2.0, 64.0) as usize;
        Self { spring, rotor, parts, error: TransmissionError::default(), q, qd: 0.0 }
    }

    /// Returns this rotor where its spring is without torque for a link where the rotor is now, behind an error of the gear.
    pub(super) fn with_error(mut self, error: TransmissionError) -> Self {
        self.q = error.motor(self.q);
        self.error = error;
        self
    }

    /// Steps by `h` s under the motor's torque, the link at `(q, qd)`; returns the torque that the spring exerts on the
    /// link meanwhile, N·m. `friction` is what friction takes at a speed.
    pub(super) fn step(&mut self, h: f64, torque: f64, (q, qd): (f64, f64), friction: impl Fn(f64) -> f64) -> f64 {
        let rate = self.qd - qd;
        let lead = self.error.lead(self.q + 0.5 * h * self.qd);
        let wound = self.q - q + 0.5 * h * rate + lead.angle;
        let spring = self.spring.torque(wound, rate + lead.slope * self.qd);
        let on_rotor = (1.0 + lead.slope) * spring;
        let dt = h / self.parts as f64;
        for _ in 0..self.parts {
            // The midpoint rule.
            let slope = |v: f64| (torque - on_rotor - friction(v)) / self.rotor;
            let middle = self.qd + 0.5 * dt * slope(self.qd);
            self.q += dt * middle;
            self.qd += dt * slope(middle);
        }
        spring
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_two_masses_swing_at_their_resonance() {
        let (stiffness, rotor, link, h) = (2e4, 0.5, 0.8, 2.5e-4);
        let omega = f64::sqrt(stiffness * (1.0 / rotor + 1.0 / link));
        // Held torque is what the plant sees; a rigid link of known inertia has a closed form.
        let mut motor = MotorSide::new(Spring::new(stiffness, 0.0, 0.0), rotor, 0.0, h, 1e-3);
        let (mut q, mut qd, mut crossings, mut first, mut last, mut most) = (0.0, 0.0, 0, 0.0, 0.0, 0.0_f64);
        let mut before = 1e-3;
        for step in 0..40_000 {
            let torque = motor.step(h, 0.0, (q, qd), |_| 0.0);
            q += h * (qd + 0.5 * h * torque / link);
            qd += h * torque / link;
            let delta = motor.q - q;
            if delta * before < 0.0 {
                last = h * (f64::from(step) + before / (before - delta));
                first = if crossings == 0 { last } else { first };
                crossings += 1;
            }
            if step > 39_000 {
                most = most.max(delta.abs());
            }
            before = delta;
        }
        let found = std::f64::consts::PI * f64::from(crossings - 1) / (last - first);
        // Leapfrog: ω is too high by (ωh)²/24 = 1.7e-4 of it; crossings are found by a line to some 1e-6.
        let expected = omega * (1.0 + (omega * h).powi(2) / 24.0);
        assert!((found - expected).abs() < 3e-6 * omega, "{found} {expected}");
        // Ten seconds, some 400 swings: neither fed nor damped. The largest of the samples misses the peak by (ωh)²/8.
        assert!((most - 1e-3).abs() < 2e-6, "{most}");
    }

    #[test]
    fn analytic_damping_takes_the_share_that_it_should() {
        let (stiffness, rotor, link, h) = (2e4, 0.5, 0.8, 1e-4);
        let omega = f64::sqrt(stiffness * (1.0 / rotor + 1.0 / link));
        let spring = Spring::new(stiffness, 0.0, 0.0).between(rotor, 1.0 / link);
        let mut motor = MotorSide::new(spring, rotor, 0.0, h, 1e-3);
        let (mut q, mut qd) = (0.0, 0.0);
        let swings = 3.0;
        let steps = (swings * std::f64::consts::TAU / (omega * (1.0 - 0.05_f64 * 0.05).sqrt()) / h).round() as usize;
        for _ in 0..steps {
            let torque = motor.step(h, 0.0, (q, qd), |_| 0.0);
            q += h * (qd + 0.5 * h * torque / link);
            qd += h * torque / link;
        }
        // δ after whole swings: exp(−ζ ω t). The spring's damper is a step h/2 late: (ωh) of its 5 %.
        let expected = 1e-3 * (-0.05 * omega * steps as f64 * h).exp();
        assert!(((motor.q - q) / expected - 1.0).abs() < 0.02, "{} {expected}", motor.q - q);
    }

    /// A free rotor and link behind an error of the gear: kinetic energies and that of the spring are what they were, and far
    /// below the resonance the link is where the error says.
    #[test]
    fn analytic_an_error_of_the_gear_takes_and_gives_no_energy() {
        let (stiffness, rotor, link, h) = (2e4, 0.5, 0.8, 5e-5);
        let error = TransmissionError::of_motors(&[(100.0, true)], 5e-4, crate::seed::Seed::new(6))[0];
        for (speed, wound) in [(1.0, 1e-2), (0.05, 1e-6)] {
            let mut motor = MotorSide::new(Spring::new(stiffness, 0.0, 0.0), rotor, 0.0, h, 0.3).with_error(error);
            assert!((motor.q + error.lead(motor.q).angle - 0.3).abs() < 1e-15);
            motor.qd = speed;
            let (mut q, mut qd) = (0.3, speed * (1.0 + error.lead(motor.q).slope));
            let (mut before, mut most, mut swing, mut strayed) = (None, 0.0_f64, 0.0_f64, 0.0_f64);
            for _ in 0..20_000 {
                let torque = motor.step(h, 0.0, (q, qd), |_| 0.0);
                q += h * (qd + 0.5 * h * torque / link);
                qd += h * torque / link;
                let delta = motor.q + error.lead(motor.q).angle - q;
                let kinetic = 0.5 * rotor * motor.qd * motor.qd + 0.5 * link * qd * qd;
                let energy = kinetic + 0.5 * stiffness * delta * delta;
                let first = *before.get_or_insert(energy);
                most = most.max((energy - first).abs());
                swing = swing.max((kinetic - first).abs());
                strayed = strayed.max(delta.abs());
            }
            // Leapfrog: the energy goes to and fro with (ωh)² of what is exchanged, at most that.
            assert!(most < 1e-3 * swing, "{most:e} of {swing:e}");
            assert!(strayed < wound, "{strayed:e}");
        }
    }

    #[test]
    fn analytic_wind_up_at_the_rating_and_the_quasi_static_inverse() {
        let rating = 40.0;
        let mut spring = Spring::new(rating / 2e-3, 3e-4, 3e-4);
        // Rated torque winds the spring by 2 mrad less what the slip elements carry, 0.15 mrad, and half the gap.
        let angle = spring.angle(rating);
        assert!((angle - (2e-3 - 1.5e-4 + 0.98 * 1.5e-4)).abs() < 1e-12, "{angle}");
        let mut other = Spring::new(rating / 2e-3, 3e-4, 3e-4);
        for torque in [rating, 12.0, -0.5, 0.3, -30.0, 5.0] {
            let angle = if torque == rating { angle } else { spring.angle(torque) };
            assert!((other.torque(angle, 0.0) - torque).abs() < 1e-9, "{torque}");
        }
    }
}
