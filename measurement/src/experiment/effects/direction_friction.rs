//! Coulomb friction that differs between the two directions.
//!
//! ```text
//! Fc⁺ = Fc (1 ± e)      Fc⁻ = Fc (1 ∓ e)      Fd = (Fc⁺ − Fc⁻)/2 = ± e Fc      the sign drawn by joint
//! ```
//! `e` is the magnitude. The law is that of the torque term [`COULOMB_DIRECTION`], which every engine has; friction of a coupled
//! motor (`Fcm`) has no such term and stays equal in both directions. Away from rest `Fd` is a constant: a model without the
//! term finds it in its offset.
//!
//! Source: P. I. Corke, B. Armstrong-Hélouvry, ICRA 1994, friction of both directions of every joint of the PUMA 560:
//! |Fc⁺ − Fc⁻|/(Fc⁺ + Fc⁻) is 0.05, 0.28, 0.11, 0.20, 0.22 and 0.45. The levels are the median and the largest.

use super::draw;
use crate::model::DriveParameters;
use crate::model::term::{COULOMB, COULOMB_DIRECTION};
use crate::seed::Seed;

/// Makes Coulomb friction of the joints differ by `share` of it up in one direction and down in the other.
pub(super) fn add(drives: &mut [DriveParameters], share: f64, seed: Seed) {
    let signs = draw::signs(seed, "direction of friction", drives.len());
    for (drive, sign) in drives.iter_mut().zip(signs) {
        let change = sign * share * drive[COULOMB];
        if change != 0.0 {
            drive[COULOMB_DIRECTION] += change;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::dynamics::Dynamics;
    use crate::experiment::hinges;
    use crate::experiment::{ActualArm, EffectKind, Effects};
    use crate::model::StandardParameters;
    use crate::model::term::{OFFSET, VISCOUS};

    /// Columns of friction away from rest, fitted to an arm whose Coulomb friction is 4 (1 ± 0.2) N·m: what it is more forward
    /// than backward is in the offset, exactly, and in nothing else.
    #[test]
    fn analytic_half_the_difference_of_both_directions_is_an_offset() {
        let robot = hinges::single();
        let mut truth = StandardParameters::zero(1);
        for (term, value) in [(COULOMB, 4.0), (VISCOUS, 5.0), (OFFSET, 0.3)] {
            truth.drives[0][term] = value;
        }
        for seed in 0..4 {
            let effects = Effects::none().with_effect(EffectKind::DirectionFriction, 0.2).with_seed(Seed::new(seed));
            let arm = ActualArm::new(&effects, &robot, &truth);
            let mut dynamics = Dynamics::new(arm.robot(), arm.parameters());
            let mut friction = |v: f64| {
                let mut tau = [0.0];
                dynamics.inverse(&[0.0], &[v], &[0.0], &mut tau);
                tau[0]
            };
            // Speeds of a hundred velocity scales and more, where the smooth sign is one to the last bit.
            let speeds: Vec<f64> = (0..10).map(|k| 1.0 + 0.1 * f64::from(k)).flat_map(|v| [v, -v]).collect();
            let forward = friction(1.0) - 5.0 - 0.3;
            let backward = -(friction(-1.0) + 5.0 - 0.3);
            assert!((0.5 * (forward + backward) - 4.0).abs() < 1e-12);
            assert!(((forward - backward).abs() - 1.6).abs() < 1e-12);
            let w = DMatrix::from_fn(20, 3, |k, j| [speeds[k], speeds[k].signum(), 1.0][j]);
            let y = DVector::from_fn(20, |k, _| friction(speeds[k]));
            let found = w.svd(true, true).solve(&y, 1e-12).unwrap();
            let expected = [5.0, 4.0, 0.3 + 0.5 * (forward - backward)];
            for j in 0..3 {
                assert!((found[j] - expected[j]).abs() < 1e-12, "{found}");
            }
        }
    }

    #[test]
    fn signs_differ_by_joint_and_a_joint_without_friction_stays_without() {
        let mut drives = vec![DriveParameters::from_iter([(COULOMB, 2.0)]); 40];
        drives[7] = DriveParameters::from_iter([(VISCOUS, 1.0)]);
        add(&mut drives, 0.2, Seed::new(3));
        assert!(drives.iter().enumerate().all(|(i, d)| d[COULOMB_DIRECTION].abs() == if i == 7 { 0.0 } else { 0.4 }));
        // 39 fair signs are all equal once in 3e11.
        assert!(drives.iter().any(|d| d[COULOMB_DIRECTION] > 0.0) && drives.iter().any(|d| d[COULOMB_DIRECTION] < 0.0));
    }
}
