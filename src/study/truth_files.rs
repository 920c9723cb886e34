//! What the simulated arms are made of, as texts. Nothing above this module can name it.

/// The `truth.toml` of a robot that is compiled in, by the name that [`bundled`](crate::model::bundled) gives it.
///
/// ```
/// use armid::{model::bundled, study::truth_text};
/// assert!(bundled().iter().all(|robot| truth_text(robot.name).is_some()));
/// assert!(truth_text("no such robot").is_none());
/// ```
#[must_use]
pub fn truth_text(robot: &str) -> Option<&'static str> {
    match robot {
        "crs-a460" => Some(include_str!("../../models/crs-a460/truth.toml")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{BaseReduction, Method};
    use crate::conformance::chains::random_state;
    use crate::dynamics::{Dynamics, States};
    use crate::excitation::table_one;
    use crate::model::format::{parse_nominal, parse_parameters, parse_robot};
    use crate::model::{Columns, Robot, StandardParameters, bundled};
    use crate::regressor::JointTorqueRegressor;
    use crate::seed::Seed;

    #[test]
    fn identity_every_truth_is_physically_consistent_and_another_than_the_guess() {
        for entry in bundled() {
            let robot = parse_robot(entry.robot).unwrap();
            let text = truth_text(entry.name).expect("a truth for every bundled robot");
            let truth = parse_parameters(text, &robot, true).unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
            let nominal = parse_nominal(entry.nominal, &robot).unwrap();
            for (i, (a, b)) in truth.parameters.links.iter().zip(&nominal.parameters.links).enumerate() {
                assert!((a.mass - b.mass).abs() <= 0.4 * a.mass, "{} link {}", entry.name, i + 1);
                assert_ne!(a, b, "{} link {}", entry.name, i + 1);
            }
            // A source for every link and drive.
            assert_eq!(truth.notes.len(), 2 * robot.dof(), "{}", entry.name);
        }
    }

    fn a460() -> (Robot, StandardParameters) {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        let truth = parse_parameters(truth_text("crs-a460").unwrap(), &robot, true).unwrap().parameters;
        (robot, truth)
    }

    #[test]
    fn published_a460_weighs_what_a_crs_arm_weighs() {
        // The CAD's 16.0 kg of structure, and 5 to 10 kg of motors and gears.
        let mass: f64 = a460().1.links.iter().map(|link| link.mass).sum();
        assert!((mass - 25.03).abs() < 1e-12, "{mass} kg");
    }

    #[test]
    fn published_a460_carries_the_papers_trajectory_inside_its_ratings() {
        let (robot, truth) = a460();
        let states = table_one::corrected().sample(1000);
        let mut dynamics = Dynamics::new(&robot, &truth);
        let (mut peak, mut tau) = ([0.0_f64; 6], [0.0; 6]);
        for k in 0..states.len() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
            for (peak, tau) in peak.iter_mut().zip(tau) {
                *peak = peak.max(tau.abs());
            }
        }
        // Computed apart by a three-vector Newton-Euler recursion in Python with the plain sign of the velocity, on the
        // same grid; the smooth sign differs by less than 0.01 N·m where a peak stands at a small speed.
        for ((peak, expected), joint) in
            peak.iter().zip([13.355, 59.789, 17.522, 2.618, 2.389, 1.252]).zip(robot.joints())
        {
            assert!((peak - expected).abs() < 0.01, "{}: {peak} N·m", joint.name);
            assert!(*peak < 0.91 * joint.limits.torque, "{}: {peak} N·m", joint.name);
        }
    }

    #[test]
    fn identity_no_base_parameter_of_the_a460_is_zero() {
        let (robot, truth) = a460();
        let mut states = States::new(6);
        let mut rng = Seed::new(1).stream("states", 0);
        for _ in 0..60 {
            let (q, qd, qdd) = random_state(&mut rng, 6);
            states.push(&q, &qd, &qdd);
        }
        let columns = Columns::RigidRotorFriction;
        let regressor = JointTorqueRegressor::new(&robot, columns);
        let base = BaseReduction::from_stack(regressor.parameters(), &regressor.stack(&states), Method::Qr);
        assert_eq!(base.rank(), 58);
        for (name, value) in base.names().iter().zip(base.beta(&truth.vector(&robot, columns)).iter()) {
            // The smallest is a product of inertia of the tool plate.
            assert!(value.abs() > 5e-6, "{name} = {value}");
        }
    }
}
