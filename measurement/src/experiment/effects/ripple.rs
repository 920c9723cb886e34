//! Torque that varies with the angle of the motor: ripple in proportion to the current, cogging without any.
//!
//! ```text
//! τ_m = K i (1 + r Σ_{h=2,6} sin(h N θ + φ_h)) + c τ_max Σ_{h=1,12} sin(h N θ + ψ_h)
//! ```
//! `N θ` is the angle of the motor, `r` and `c` the shares, `τ_max` the rating of the joint; phases are drawn by motor.
//! A harmonic drive passes its error on twice a motor turn, six pole pairs or commutator bars give the sixth harmonic,
//! and twelve slots the twelfth.
//!
//! Source: T. Tuttle, W. Seering, "A nonlinear model of a harmonic drive gear
//! transmission", *IEEE T-RA* 12(3), 1996 (twice a turn); the sizes are assumed.

use super::draw;
use crate::seed::Seed;

/// Harmonics of a motor turn in ripple.
const RIPPLE: [f64; 2] = [2.0, 6.0];
/// Harmonics of a motor turn in cogging.
const COGGING: [f64; 2] = [1.0, 12.0];

/// Ripple and cogging of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ripple {
    gear: f64,
    share: f64,
    phase: [f64; 2],
    /// Amplitude of each harmonic of cogging, N·m.
    cogging: f64,
    cogging_phase: [f64; 2],
}

fn sum(harmonics: [f64; 2], angle: f64, phase: [f64; 2]) -> f64 {
    libm::sin(harmonics[0] * angle + phase[0]) + libm::sin(harmonics[1] * angle + phase[1])
}

impl Ripple {
    /// Of motors with these (gear, torque rating); `share` of ripple, `cogging` as a share of the rating.
    pub(super) fn of_motors(motors: &[(f64, f64)], share: f64, cogging: f64, seed: Seed) -> Vec<Self> {
        let ripple = draw::phases(seed, "torque ripple", 2 * motors.len());
        let teeth = draw::phases(seed, "cogging", 2 * motors.len());
        let pair = |phases: &[f64], i: usize| [phases[2 * i], phases[2 * i + 1]];
        motors
            .iter()
            .enumerate()
            .map(|(i, &(gear, rating))| Self {
                gear,
                share,
                phase: pair(&ripple, i),
                cogging: cogging * rating,
                cogging_phase: pair(&teeth, i),
            })
            .collect()
    }

    /// Torque of the motor that would give `ideal` (N·m) without them, at its coordinate `q` after the gear, rad.
    pub(super) fn torque(&self, ideal: f64, q: f64) -> f64 {
        let angle = self.gear * q;
        let mut torque = ideal;
        if self.share > 0.0 {
            torque += ideal * self.share * sum(RIPPLE, angle, self.phase);
        }
        if self.cogging > 0.0 {
            torque += self.cogging * sum(COGGING, angle, self.cogging_phase);
        }
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_mean_square_over_a_motor_turn() {
        let motor = Ripple::of_motors(&[(100.0, 40.0)], 0.03, 0.0, Seed::new(1))[0];
        let teeth = Ripple::of_motors(&[(100.0, 40.0)], 0.0, 0.02, Seed::new(1))[0];
        let count = 1000;
        let turn = std::f64::consts::TAU / 100.0;
        let over_a_turn = |motor: &Ripple, ideal: f64| -> (f64, f64) {
            let values: Vec<f64> =
                (0..count).map(|k| motor.torque(ideal, turn * f64::from(k) / f64::from(count)) - ideal).collect();
            let mean = values.iter().sum::<f64>() / f64::from(count);
            (mean, values.iter().map(|v| v * v).sum::<f64>() / f64::from(count))
        };
        // Two sines of amplitude a: mean 0, mean square a². Ripple: 0.03 · 10 N·m; cogging: 0.02 · 40 N·m at any current.
        let (mean, square) = over_a_turn(&motor, 10.0);
        assert!(mean.abs() < 1e-12 && (square - 0.09).abs() < 1e-12, "{mean} {square}");
        for ideal in [0.0, 10.0] {
            let (mean, square) = over_a_turn(&teeth, ideal);
            assert!(mean.abs() < 1e-12 && (square - 0.64).abs() < 1e-12, "{mean} {square}");
        }
    }
}
