//! Angles that are read wrong once a turn: of the motor by a disc off its axis, of the joint by a gear off its axis.
//!
//! ```text
//! q̂ = q + (e_m/N) sin(N q + φ) + e_j sin(q + ψ)      phases drawn by joint
//! ```
//! `N` is the gear. A prismatic joint has no angle of its own: `e_j` is then left out.

use super::draw;
use crate::seed::Seed;

/// Eccentricity of the encoder and the gear of one joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::experiment) struct Eccentricity {
    gear: f64,
    motor: f64,
    motor_phase: f64,
    joint: f64,
    joint_phase: f64,
}

impl Eccentricity {
    /// Of joints with these (gear, whether they are revolute); amplitudes at motor and joint, rad.
    pub(super) fn of_joints(joints: &[(f64, bool)], motor: f64, joint: f64, seed: Seed) -> Vec<Self> {
        let discs = draw::phases(seed, "motor eccentricity", joints.len());
        let gears = draw::phases(seed, "joint eccentricity", joints.len());
        joints
            .iter()
            .zip(discs.into_iter().zip(gears))
            .map(|(&(gear, turns), (motor_phase, joint_phase))| Self {
                gear,
                motor: motor / gear,
                motor_phase,
                joint: if turns { joint } else { 0.0 },
                joint_phase,
            })
            .collect()
    }

    /// What is read too much at the motor's coordinate `q` after the gear, rad (m).
    pub(in crate::experiment) fn error(&self, q: f64) -> f64 {
        let mut error = 0.0;
        if self.motor > 0.0 {
            error += self.motor * libm::sin(self.gear * q + self.motor_phase);
        }
        if self.joint > 0.0 {
            error += self.joint * libm::sin(q + self.joint_phase);
        }
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_errors_repeat_each_turn_and_have_their_amplitudes() {
        let turn = std::f64::consts::TAU;
        let disc = Eccentricity::of_joints(&[(100.0, true)], 5e-3, 0.0, Seed::new(1))[0];
        let gear = Eccentricity::of_joints(&[(100.0, true)], 0.0, 2e-4, Seed::new(1))[0];
        for (wrong, period, amplitude) in [(disc, turn / 100.0, 5e-5), (gear, turn, 2e-4)] {
            let count = 720;
            let at = |k: i32| wrong.error(period * f64::from(k) / f64::from(count));
            let square: f64 = (0..count).map(|k| at(k) * at(k)).sum();
            // A sine's mean square is half its amplitude's.
            assert!((square / f64::from(count) - 0.5 * amplitude * amplitude).abs() < 1e-12 * amplitude);
            assert!((at(0) - at(count)).abs() < 1e-12 * amplitude && (at(0) + at(count / 2)).abs() < 1e-12 * amplitude);
        }
        assert_eq!(Eccentricity::of_joints(&[(100.0, false)], 0.0, 2e-4, Seed::new(1))[0].error(1.0), 0.0);
    }
}
