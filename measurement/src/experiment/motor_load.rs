//! What each motor has to turn, by the nominal parameters: what a controller's gains are placed on.

use nalgebra::{DMatrix, DVector};

use super::servo_error::ServoError;
use super::transmission::Transmission;
use crate::dynamics::Dynamics;
use crate::model::term::{COULOMB, VISCOUS};
use crate::model::{Joint, Robot, StandardParameters};

/// The pose at which gains are placed: every joint a quarter of its range above the middle of it, 45° where it has no
/// limits. An arm with its elbow half bent, neither folded nor stretched; n, rad (m).
pub fn gain_pose(robot: &Robot) -> Vec<f64> {
    let place = |joint: &Joint| {
        let (low, high) = joint.limits.position;
        if (high - low).is_finite() { low + 0.75 * (high - low) } else { std::f64::consts::FRAC_PI_4 }
    };
    robot.joints().iter().map(place).collect()
}

/// Inertia and friction that the motors see while the others stand still, in motor coordinates after the gear; n each.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorLoad {
    /// Inertia at the gain pose, kg·m².
    pub inertia: Vec<f64>,
    /// Viscous friction, N·m·s/rad.
    pub viscous: Vec<f64>,
    /// Coulomb friction over the speed limits of the joints, N·m·s/rad; zero where there are none.
    pub coulomb_per_speed: Vec<f64>,
}

impl MotorLoad {
    /// The load of a robot's motors.
    ///
    /// # Errors
    /// [`ServoError`] where the nominal parameters are of another robot, or give a motor no inertia.
    pub fn new(robot: &Robot, nominal: &StandardParameters) -> Result<Self, ServoError> {
        let (found, expected) = (nominal.links.len(), robot.dof());
        if found != expected {
            return Err(ServoError::Dof { quantity: "nominal parameter set", found, expected });
        }
        let transmission = Transmission::new(robot);
        let inertia = transmission.motor_inertia(&Dynamics::new(robot, nominal).mass_matrix(&gain_pose(robot)));
        for (joint, &inertia) in robot.joints().iter().zip(&inertia) {
            if !(inertia.is_finite() && inertia > 0.0) {
                return Err(ServoError::Inertia { joint: joint.name.clone(), inertia });
            }
        }
        // Friction goes through a coupling as inertia does.
        let seen = |of_joint: &dyn Fn(usize) -> f64| {
            let of_each = DVector::from_fn(expected, |i, _| of_joint(i).max(0.0));
            transmission.motor_inertia(&DMatrix::from_diagonal(&of_each))
        };
        let viscous = seen(&|i| nominal.drives[i][VISCOUS]);
        let coulomb_per_speed = seen(&|i| nominal.drives[i][COULOMB] / robot.joints()[i].limits.velocity);
        Ok(Self { inertia, viscous, coulomb_per_speed })
    }
}

#[cfg(test)]
mod tests {
    use super::{MotorLoad, gain_pose};
    use crate::experiment::hinges;
    use crate::model::term::{COULOMB, VISCOUS};

    #[test]
    fn analytic_gain_pose_is_three_quarters_up_the_range() {
        assert!((gain_pose(&hinges::single())[0] - 1.5).abs() < 1e-15);
    }

    #[test]
    fn analytic_friction_goes_through_a_coupling_as_inertia_does() {
        // C = [1 0; 1 1]: motor 1 turns joint 1 forwards and joint 2 backwards, C⁻ᵀ D C⁻¹ has the diagonal (d₁ + d₂, d₂).
        let mut nominal = hinges::parameters(2);
        for (drive, friction) in nominal.drives.iter_mut().zip([1.5, 6.0]) {
            (drive[VISCOUS], drive[COULOMB]) = (friction, 2.0 * friction);
        }
        let load = MotorLoad::new(&hinges::coupled(), &nominal).unwrap();
        assert_eq!(load.viscous, [7.5, 6.0]);
        // The speed limit is 3 rad/s.
        assert_eq!(load.coulomb_per_speed, [5.0, 4.0]);
    }
}
