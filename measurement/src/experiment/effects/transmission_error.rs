//! The kinematic error of a harmonic drive: its link leads and lags the motor.
//!
//! ```text
//! C q = θ + ε(θ)        ε(θ) = a sin(2 N θ + φ_2) + a/2 sin(N θ + φ_1)        phases drawn by motor
//! J θ̈ = τ_m − f(θ̇) − (1 + ε′) τ_s        power: (1 + ε′) θ̇ = C q̇, so that τ_m θ̇ = τ_s C q̇ without rotor and friction
//! ```
//! `θ` is the motor after its gear, where the encoder is, `N θ` the angle of the wave generator, `a` the magnitude, `τ_s` the torque
//! on the link. The wave generator is an ellipse, so that the error goes on twice in its turn; half of it once is assumed.
//!
//! With a [spring](super::elasticity) between motor and link `ε` winds it: `δ = θ + ε(θ) − C q`, and drives it through its resonance where
//! `2 N θ̇` meets that. Without one the coordinates of the plant are those of the motors, and the links follow unevenly
//! ([`uneven_links`](super::uneven_links)); so do joints of the wrist, whose springs are quasi-static. A prismatic joint has no harmonic
//! drive.
//!
//! Sources: T. Tuttle, W. Seering, *IEEE T-RA* 12(3), 1996, and F. Ghorbel, P. Gandhi, F. Alpeter, *J. Mech. Design* 123(1), 2001 (the model, and
//! harmonics); Harmonic Drive AG, HFUC catalogue: transmission accuracy of 1 arcmin from crest to crest, 0.15 mrad of amplitude,
//! the realistic level. The severe one is assumed.

use super::draw;
use crate::seed::Seed;

/// Harmonics of a motor turn.
const HARMONICS: [f64; 2] = [2.0, 1.0];
/// Their amplitudes as shares of the magnitude.
const SHARES: [f64; 2] = [1.0, 0.5];
/// Steps of the iteration for the motor of a link: each leaves at most a share `N a (2 + ½)` of the error.
const STEPS: usize = 60;

/// The error of one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TransmissionError {
    gear: f64,
    amplitude: f64,
    phase: [f64; 2],
}

/// By how much a link leads its motor, and how that changes with the motor's coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lead {
    /// ε, rad.
    pub(super) angle: f64,
    /// ε′.
    pub(super) slope: f64,
    /// ε″, 1/rad.
    pub(super) curvature: f64,
}

impl TransmissionError {
    /// Of motors with these (gear, whether the joint is revolute) and an amplitude in rad.
    pub(super) fn of_motors(motors: &[(f64, bool)], amplitude: f64, seed: Seed) -> Vec<Self> {
        let phases = draw::phases(seed, "transmission error", 2 * motors.len());
        let of = |(i, &(gear, turns)): (usize, &(f64, bool))| {
            // One without an error is the default, whatever its gear.
            let phase = [phases[2 * i], phases[2 * i + 1]];
            if turns && amplitude > 0.0 { Self { gear, amplitude, phase } } else { Self::default() }
        };
        motors.iter().enumerate().map(of).collect()
    }

    /// The lead where the motor is at `q` after its gear, rad.
    pub(super) fn lead(&self, q: f64) -> Lead {
        let mut lead = Lead::default();
        if self.amplitude == 0.0 {
            return lead;
        }
        for k in 0..HARMONICS.len() {
            let (wave, amplitude) = (HARMONICS[k] * self.gear, SHARES[k] * self.amplitude);
            let (sine, cosine) = libm::sincos(wave * q + self.phase[k]);
            lead.angle += amplitude * sine;
            lead.slope += amplitude * wave * cosine;
            lead.curvature -= amplitude * wave * wave * sine;
        }
        lead
    }

    /// Largest |ε′|.
    pub(super) fn steepest(&self) -> f64 {
        self.gear * self.amplitude * (HARMONICS[0] * SHARES[0] + HARMONICS[1] * SHARES[1])
    }

    /// Where the motor of a link at `link` is, rad.
    pub(super) fn motor(&self, link: f64) -> f64 {
        (0..STEPS).fold(link, |q, _| link - self.lead(q).angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm without it keeps its bits: nothing of what it needs is made.
    #[test]
    fn identity_without_an_amplitude_or_a_turn_there_is_no_error() {
        let none = TransmissionError::default();
        assert!(
            TransmissionError::of_motors(&[(100.0, true), (50.0, true)], 0.0, Seed::new(2)).iter().all(|e| *e == none)
        );
        let [linear, turning] = TransmissionError::of_motors(&[(100.0, false), (100.0, true)], 1e-4, Seed::new(2))[..]
        else {
            panic!("two")
        };
        assert!(linear == none && turning != none);
    }

    #[test]
    fn analytic_two_waves_and_one_in_a_turn_of_the_motor() {
        let (gear, amplitude, count) = (100.0, 2e-4, 720);
        let error = TransmissionError::of_motors(&[(gear, true)], amplitude, Seed::new(2))[0];
        let turn = std::f64::consts::TAU / gear;
        let at = |k: i32| error.lead(turn * f64::from(k) / f64::from(count)).angle;
        // Half a turn on, the even part is the same and the odd one opposite.
        let part = |sign: f64| (0..count).map(|k| (0.5 * (at(k) + sign * at(k + count / 2))).powi(2)).sum::<f64>();
        let mean = f64::from(count);
        assert!((part(1.0) / mean / (0.5 * amplitude * amplitude) - 1.0).abs() < 1e-10);
        assert!((part(-1.0) / mean / (0.125 * amplitude * amplitude) - 1.0).abs() < 1e-10);
        let sliding = &TransmissionError::of_motors(&[(gear, false)], amplitude, Seed::new(2))[0];
        assert_eq!(sliding.lead(0.3), Lead::default());
    }

    #[test]
    fn identity_slope_and_curvature_are_those_of_the_angle_and_the_motor_of_a_link_is_found() {
        let error = TransmissionError::of_motors(&[(100.0, true)], 1e-3, Seed::new(4))[0];
        for k in 0..50 {
            let (q, h) = (0.037 * f64::from(k), 1e-6);
            let (before, here, after) = (error.lead(q - h), error.lead(q), error.lead(q + h));
            // Truncation h²/6 (2N)³ a, and (2N)⁴ a.
            assert!(((after.angle - before.angle) / (2.0 * h) - here.slope).abs() < 1e-8);
            assert!(((after.slope - before.slope) / (2.0 * h) - here.curvature).abs() < 1e-5);
            let link = q + here.angle;
            assert!((error.motor(link) - q).abs() < 1e-14, "{} {q}", error.motor(link));
        }
    }
}
