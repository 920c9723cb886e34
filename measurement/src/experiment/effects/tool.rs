//! A tool at the flange that the identification model does not have.
//!
//! ```text
//! I_n ← I_n + I(m, c, 2/5 m r²)      c = (0.02, 0, 0.06) m in the frame of the last link, r = 0.03 m
//! ```
//! A ball stands for the tool: it adds weight and inertia, and has few numbers. Its place is assumed.

use nalgebra::{Matrix3, Vector3};

use crate::model::StandardParameters;
use crate::spatial::Inertia;

/// Centre of the tool in the frame of the last link, m.
const CENTRE: [f64; 3] = [0.02, 0.0, 0.06];
/// Radius of the ball, m.
const RADIUS: f64 = 0.03;

/// Adds a tool of `mass` kg to the last link.
pub(super) fn add(parameters: &mut StandardParameters, mass: f64) {
    let ball = Matrix3::from_diagonal_element(0.4 * mass * RADIUS * RADIUS);
    let tool = Inertia::from_com(mass, Vector3::from(CENTRE), ball);
    if let Some(last) = parameters.links.last_mut() {
        *last += tool;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::dynamics::Dynamics;

    #[test]
    fn analytic_a_tool_on_a_planar_arm_weighs_at_its_lever() {
        let robot = chains::planar_2r();
        let mut parameters = StandardParameters::zero(2);
        add(&mut parameters, 1.5);
        let (mut tau, zero) = ([0.0; 2], [0.0; 2]);
        Dynamics::new(&robot, &parameters).inverse(&zero, &zero, &zero, &mut tau);
        // Stretched out: links of 0.4 and 0.3 m in the vertical plane, the centre 0.02 m beyond the end.
        let reach = robot.poses(&zero)[1].translation;
        assert!((tau[0] - 1.5 * 9.81 * (reach.norm() + 0.02)).abs() < 1e-12, "{tau:?}");
        assert!(parameters.links[1].check().is_ok());
    }
}
