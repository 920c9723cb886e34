//! Coulomb friction that depends on where the joint is.
//!
//! ```text
//! Fc(q) = Fc (1 + e cos(q/l − φ)) = Fc + Fpc cos(q/l) + Fps sin(q/l)      Fpc = e Fc cos φ, Fps = e Fc sin φ
//! ```
//! `e` is the magnitude, `φ` drawn by joint, `l` the wave of the robot file (`friction_wave_rad`): 1 rad, one wave in a turn of the
//! joint, where it says nothing; ½ rad are two. The law is that of the torque terms [`POSITION_COSINE`] and [`POSITION_SINE`],
//! which every engine has. Over a whole wave the mean is Fc.
//!
//! Source: B. Armstrong, "Friction: experimental determination, modeling and compensation", ICRA 1988, who found friction of
//! the PUMA 560 to depend on position, repeatably, by gears that run out of true. The levels are assumed.

use super::draw;
use crate::model::DriveParameters;
use crate::model::term::{COULOMB, POSITION_COSINE, POSITION_SINE};
use crate::seed::Seed;

/// Makes Coulomb friction of the joints vary with position by `share` of it.
pub(super) fn add(drives: &mut [DriveParameters], share: f64, seed: Seed) {
    let phases = draw::phases(seed, "position of friction", drives.len());
    for (drive, phase) in drives.iter_mut().zip(phases) {
        let amplitude = share * drive[COULOMB];
        if amplitude != 0.0 {
            let (sine, cosine) = libm::sincos(phase);
            drive[POSITION_COSINE] += amplitude * cosine;
            drive[POSITION_SINE] += amplitude * sine;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Dynamics;
    use crate::experiment::hinges;
    use crate::experiment::{ActualArm, EffectKind, Effects};
    use crate::model::StandardParameters;

    #[test]
    fn analytic_mean_and_mean_square_over_a_turn() {
        let robot = hinges::single();
        let mut truth = StandardParameters::zero(1);
        truth.drives[0][COULOMB] = 4.0;
        let effects = Effects::none().with_effect(EffectKind::PositionFriction, 0.3).with_seed(Seed::new(5));
        let arm = ActualArm::new(&effects, &robot, &truth);
        let mut dynamics = Dynamics::new(arm.robot(), arm.parameters());
        for direction in [1.0, -1.0] {
            let count = 360;
            let (mut mean, mut square, mut least, mut most) = (0.0, 0.0, f64::INFINITY, 0.0_f64);
            for k in 0..count {
                let q = std::f64::consts::TAU * f64::from(k) / f64::from(count);
                let mut tau = [0.0];
                dynamics.inverse(&[q], &[direction], &[0.0], &mut tau);
                let friction = direction * tau[0];
                mean += friction / f64::from(count);
                square += (friction - 4.0).powi(2) / f64::from(count);
                (least, most) = (least.min(friction), most.max(friction));
            }
            // A cosine of 1.2 N·m: mean 0, mean square 0.72; a degree from its peak it is 1.5e-4 less at most.
            assert!((mean - 4.0).abs() < 1e-12 && (square - 0.72).abs() < 1e-12, "{mean} {square}");
            assert!((least - 2.8).abs() < 2e-4 && (most - 5.2).abs() < 2e-4, "{least} {most}");
        }
    }
}
