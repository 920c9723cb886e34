//! A base that does not stand level.
//!
//! ```text
//! g ← R(u, ε) g      u a horizontal axis whose direction is drawn, ε the tilt
//! ```
//! Turning gravity against the arm is the same as tilting the arm; encoders do not see it.

use nalgebra::Vector3;

use super::draw;
use crate::model::Robot;
use crate::seed::Seed;

/// The robot on a base that is `degrees` off the plumb line.
pub(super) fn tilt(robot: &Robot, degrees: f64, seed: Seed) -> Robot {
    let gravity = robot.base().rotation * robot.gravity();
    let (sin, cos) = libm::sincos(draw::phases(seed, "direction of the base's tilt", 1)[0]);
    let (sin_tilt, cos_tilt) = libm::sincos(degrees.to_radians());
    let axis = Vector3::new(cos, sin, 0.0);
    // Rodrigues' formula with the sine and cosine of one place.
    let turned = gravity * cos_tilt + axis.cross(&gravity) * sin_tilt + axis * (axis.dot(&gravity) * (1.0 - cos_tilt));
    robot.clone().with_gravity(turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{ChainRecipe, random_state};
    use crate::dynamics::Dynamics;
    use nalgebra::{Rotation3, Unit};

    #[test]
    fn identity_a_tilted_arm_is_rotated_gravity_in_newton_euler() {
        let mut rng = Seed::new(4).stream("tilt", 0);
        let (robot, parameters) = ChainRecipe::new(4).draw(&mut rng);
        let seed = Seed::new(11);
        let tilted = tilt(&robot, 3.0, seed);
        let angle = draw::phases(seed, "direction of the base's tilt", 1)[0];
        let axis = Unit::new_normalize(Vector3::new(angle.cos(), angle.sin(), 0.0));
        let rotation = Rotation3::from_axis_angle(&axis, 3.0_f64.to_radians());
        let down = robot.base().rotation * robot.gravity();
        let expected = robot.clone().with_gravity(rotation * down);
        let (q, qd, _) = random_state(&mut rng, 4);
        let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
        Dynamics::new(&tilted, &parameters).inverse(&q, &qd, &[0.0; 4], &mut a);
        Dynamics::new(&expected, &parameters).inverse(&q, &qd, &[0.0; 4], &mut b);
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
        }
        assert!(
            ((tilted.base().rotation * tilted.gravity()).normalize().dot(&down.normalize())
                - 3.0_f64.to_radians().cos())
            .abs()
                < 1e-14
        );
    }
}
