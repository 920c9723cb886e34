//! A spring to a joint: a gravity compensator.
//!
//! ```text
//! g = q − q_0        φ = Ks        E = ½ (q − q_0)²
//! ```
//! `q_0` is the angle at which the spring is at rest, from the robot file; an error of it is an offset. A spring at a
//! lever, whose torque is a sine of the angle, is another law.

use super::entry::{
    ByJoint, Carrier, Dimension, Dissipation, Needs, Place, Prior, PriorOf, ShapeParameter, Sign, Structure, TermEntry,
};
use super::input::TermInput;
use super::law::TermLaw;
use super::number::Number;

/// See the module.
#[derive(Debug)]
pub struct JointSpring;

impl JointSpring {
    /// Where the spring is at rest.
    pub const REST: ShapeParameter = ShapeParameter {
        key: "spring_rest_rad",
        meaning: "coordinate at which the spring is at rest, rad (m)",
        default: 0.0,
        smooths: false,
    };

    /// Everything but the law.
    pub const ENTRY: TermEntry = TermEntry {
        symbol: "Ks",
        name: "spring",
        meaning: "stiffness of the spring",
        group: "springs",
        place: Place::Joint,
        carrier: Carrier::Link,
        dimension: Dimension { effort: 0, coordinate: 1, per_time: 0 },
        unit: ByJoint { revolute: "N·m/rad", prismatic: "N/m" },
        key: ByJoint { revolute: "spring_nm_rad", prismatic: "spring_n_m" },
        sign: Sign::NotNegative,
        dissipation: Dissipation::Stores,
        structure: Structure::Function { family: "coordinate", odd: true },
        prior: Prior { key: "spring", of: PriorOf::Value, default: Some(0.3) },
        needs: Needs::MOTION,
        shapes: &[Self::REST],
    };
}

impl TermLaw for JointSpring {
    fn entry(&self) -> &'static TermEntry {
        &Self::ENTRY
    }

    #[inline(always)]
    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.q - x.q.constant(x.shape[0].value)
    }

    fn energy(&self, x: &TermInput<f64>) -> f64 {
        let deflection = x.q - x.shape[0].value;
        0.5 * deflection * deflection
    }
}

#[cfg(test)]
mod tests {
    use super::super::SPRING;
    use crate::chains::planar_2r;
    use crate::dynamics::Dynamics;
    use crate::model::StandardParameters;
    use crate::model::format::{parse_parameters, parse_robot};

    #[test]
    fn analytic_a_spring_from_a_file_pulls_back_to_its_rest() {
        let robot = crate::model::bundled().iter().find(|entry| entry.name == "planar-2r").unwrap().robot;
        let stated = robot.replacen(
            "coulomb_velocity_rad_s = 0.01",
            "coulomb_velocity_rad_s = 0.01\nshape = { spring_rest_rad = 0.4 }",
            1,
        );
        let robot = parse_robot(&stated).unwrap().with_gravity(nalgebra::Vector3::zeros());
        let links: String = robot
            .joints()
            .iter()
            .map(|joint| {
                format!(
                    "[[link]]\nname = \"{}\"\nmass_kg = 1\nfirst_moment_kg_m = [0, 0, 0]\ninertia_kg_m2 = \
                     {{ xx = 1, xy = 0, xz = 0, yy = 1, yz = 0, zz = 1 }}\n",
                    joint.name
                )
            })
            .collect();
        let text = format!("{links}[[drive]]\njoint = \"{}\"\nspring_nm_rad = 30\n", robot.joints()[0].name);
        let parameters = parse_parameters(&text, &robot, true).unwrap().parameters;
        let mut tau = [0.0; 2];
        Dynamics::new(&robot, &parameters).inverse(&[0.9, 0.0], &[0.0; 2], &[0.0; 2], &mut tau);
        // What holds it: 30 N·m/rad times 0.5 rad.
        assert!((tau[0] - 15.0).abs() < 1e-12 && tau[1].abs() < 1e-12, "{tau:?}");
        let unknown = stated.replace("spring_rest_rad", "spring_rest_deg");
        let fault = parse_robot(&unknown).unwrap_err().to_string();
        assert!(fault.contains("shape parameter \"spring_rest_deg\" belongs to no term"), "{fault}");
    }

    #[test]
    fn analytic_energy_of_a_stretched_spring() {
        let mut parameters = StandardParameters::zero(2);
        parameters.drives[1][SPRING] = 8.0;
        let energy = Dynamics::new(&planar_2r(), &parameters).energy(&[0.3, 0.5], &[0.0; 2]);
        assert!((energy.potential - 1.0).abs() < 1e-15 && energy.kinetic == 0.0);
    }
}
