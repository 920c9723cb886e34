//! The torque of a hose or a bundle of cables that is laid along a joint.
//!
//! ```text
//! τ_c = k (q − q_0) + Σ_j s_j        k = e τ_max        s_j: four slip elements of a loop w = 0.2 rad (m) wide
//! ```
//! `e` is the magnitude: torque a radian (a metre) from rest as a share of the joint's rating `τ_max`. The spring is the torque term
//! [`SPRING`], which every engine has, at rest where the robot file says (`spring_rest_rad`, 0 where it says nothing). The
//! strands of a bundle rub on each other as it bends: the slip elements are those of [`hysteresis`](super::hysteresis), with
//! their friction of `k w/2` in all, held by the servo over a part of its step. A bundle that is let go stops within `w/2` of its
//! rest. A joint without a rating has no cable.
//!
//! Source of the law: F. Al-Bender, V. Lampaert, J. Swevers, *IEEE TAC* 50(11), 2005, for the slip elements; that of a spring
//! and the sizes are assumed.

use super::hysteresis::Slips;
use crate::model::DriveParameters;
use crate::model::term::SPRING;

/// Width of the loop at zero torque, rad (m).
const LOOP: f64 = 0.2;

/// Stiffness of the cable at a joint of this rating (N·m), N·m/rad.
fn stiffness(rating: f64, share: f64) -> f64 {
    if rating.is_finite() { share * rating } else { 0.0 }
}

/// Adds the springs of cables to joints with these ratings, N·m.
pub(super) fn add(drives: &mut [DriveParameters], ratings: &[f64], share: f64) {
    for (drive, &rating) in drives.iter_mut().zip(ratings) {
        let stiffness = stiffness(rating, share);
        if stiffness != 0.0 {
            drive[SPRING] += stiffness;
        }
    }
}

/// What the strands of one cable take as it bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strands {
    slips: Slips,
    at: f64,
}

impl Strands {
    /// Of a cable at a joint of this rating (N·m), which has lain at `start` for long.
    pub(super) fn new(rating: f64, share: f64, start: f64) -> Self {
        Self { slips: Slips::new(stiffness(rating, share), LOOP), at: start }
    }

    /// Torque at `q`, N·m; the state moves there.
    pub(super) fn torque(&mut self, q: f64) -> f64 {
        self.slips = self.slips.wound(q - self.at);
        self.at = q;
        self.slips.torque()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::dynamics::Dynamics;
    use crate::experiment::{ActualArm, EffectKind, Effects};
    use crate::model::StandardParameters;
    use crate::model::term::JointSpring;
    use nalgebra::Vector3;

    /// An arm of no mass where there is no gravity needs the torque of its cables and nothing else.
    #[test]
    fn analytic_spring_of_a_planar_arm_without_gravity() {
        let robot = chains::planar_2r().with_gravity(Vector3::zeros());
        let robot = robot
            .with_joints(|joint| {
                joint.limits.torque = 40.0;
                joint.drive.shapes.insert(JointSpring::REST.key.to_owned(), 0.25);
            })
            .unwrap();
        let effects = Effects::none().with_effect(EffectKind::Cable, 0.02);
        let arm = ActualArm::new(&effects, &robot, &StandardParameters::zero(2));
        let mut tau = [0.0; 2];
        let q = [0.75, -1.25];
        Dynamics::new(arm.robot(), arm.parameters()).inverse(&q, &[0.4, -0.2], &[1.0, 2.0], &mut tau);
        // 0.8 N·m/rad.
        assert!((tau[0] - 0.4).abs() < 1e-14 && (tau[1] + 1.2).abs() < 1e-14, "{tau:?}");
    }

    #[test]
    fn analytic_a_cable_bent_and_let_go_stops_half_a_loop_from_its_rest() {
        let (rating, share) = (40.0, 0.02);
        let mut strands = Strands::new(rating, share, 0.0);
        let stiffness = 0.8;
        // Bent far, the strands take k w/2 whatever the speed, and as much the other way.
        assert!((strands.torque(1.0) - 0.5 * LOOP * stiffness).abs() < 1e-15);
        assert!((strands.torque(-1.0) + 0.5 * LOOP * stiffness).abs() < 1e-15);
        let rest = (0..=2000).map(|k| -1.0 + 1e-3 * f64::from(k)).find(|&q| stiffness * q + strands.torque(q) >= 0.0);
        // On the way from −1 rad all elements have slipped after 0.4 rad: the torque is zero where k q = −k w/2.
        assert!((rest.unwrap() + 0.5 * LOOP).abs() < 2e-3, "{rest:?}");
        assert_eq!(Strands::new(f64::INFINITY, share, 0.0).torque(1.0), 0.0);
    }
}
