//! What the simulated arms are made of, as texts. Nothing above this module can name it.

/// The `truth.toml` of a robot that is compiled in, by the name that [`bundled`](crate::model::bundled) gives it.
///
/// ```
/// use armid::{model::bundled, study::truth_text};
/// assert!(bundled().iter().all(|robot| truth_text(robot.name).is_some()));
/// assert!(truth_text("no such robot").is_none());
/// ```
pub fn truth_text(robot: &str) -> Option<&'static str> {
    match robot {
        "crs-a460" => Some(include_str!("../../models/crs-a460/truth.toml")),
        "puma-560" => Some(include_str!("../../models/puma-560/truth.toml")),
        "staubli-tx40" => Some(include_str!("../../models/staubli-tx40/truth.toml")),
        "planar-2r" => Some(include_str!("../../models/planar-2r/truth.toml")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{BaseReduction, Method, reduce};
    use crate::conformance::chains::random_state;
    use crate::dynamics::{Dynamics, States};
    use crate::model::format::{parse_nominal, parse_parameters, parse_robot};
    use crate::model::term::{COULOMB, COULOMB_DIRECTION, OFFSET, ROTOR};
    use crate::model::{Columns, DriveParameters, Robot, StandardParameters, bundled};
    use crate::regressor::JointTorqueRegressor;
    use crate::seed::Seed;
    use crate::trajectory::table_one;

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

    fn simulated(name: &str) -> (Robot, StandardParameters) {
        let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        let truth = parse_parameters(truth_text(name).unwrap(), &robot, true).unwrap().parameters;
        (robot, truth)
    }

    #[test]
    fn published_a460_weighs_what_a_crs_arm_weighs() {
        // The CAD's 16.0 kg of structure, and 5 to 10 kg of motors and gears.
        let mass: f64 = simulated("crs-a460").1.links.iter().map(|link| link.mass).sum();
        assert!((mass - 25.03).abs() < 1e-12, "{mass} kg");
    }

    #[test]
    fn published_a460_carries_the_papers_trajectory_inside_its_ratings() {
        let (robot, truth) = simulated("crs-a460");
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
        let (robot, truth) = simulated("crs-a460");
        let mut states = States::new(6);
        let mut rng = Seed::new(1).stream("states", 0);
        for _ in 0..60 {
            let (q, qd, qdd) = random_state(&mut rng, 6);
            states.push(&q, &qd, &qdd);
        }
        let columns = Columns::RIGID_ROTOR_FRICTION;
        let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
        let base = BaseReduction::from_stack(regressor.parameters(), &regressor.stack(&states), Method::Qr);
        assert_eq!(base.rank(), 58);
        for (name, value) in base.names().iter().zip(base.beta(&truth.vector(&robot, columns)).iter()) {
            // The smallest is a product of inertia of the tool plate.
            assert!(value.abs() > 5e-6, "{name} = {value}");
        }
    }

    #[test]
    fn published_puma_keeps_every_base_parameter_and_becomes_possible() {
        let (robot, truth) = simulated("puma-560");
        let text = include_str!("../../models/puma-560/published.toml");
        let impossible = parse_parameters(text, &robot, true).unwrap_err();
        assert!(impossible.message.contains("link \"waist\" is physically inconsistent"), "{impossible}");
        let published = parse_parameters(text, &robot, false).unwrap().parameters;
        assert!(published.links[2].check().is_err());
        assert_eq!(published.drives, truth.drives);
        let columns = Columns::RIGID_ROTOR_FRICTION;
        for method in Method::ALL {
            let base = reduce(&robot, columns, method, Seed::new(1)).unwrap();
            let (a, b) = (base.beta(&published.vector(&robot, columns)), base.beta(&truth.vector(&robot, columns)));
            // 0.02 kg·m² taken here and given there: what is left is the rounding of sums of order one.
            assert!((&a - &b).amax() < 1e-12 * a.amax(), "{}", method.name());
        }
        // And by the torques themselves, which use no reduction.
        let mut rng = Seed::new(2).stream("states", 0);
        let (mut by_published, mut by_truth) = (Dynamics::new(&robot, &published), Dynamics::new(&robot, &truth));
        for _ in 0..50 {
            let (q, qd, qdd) = random_state(&mut rng, 6);
            let (mut a, mut b) = ([0.0; 6], [0.0; 6]);
            by_published.inverse(&q, &qd, &qdd, &mut a);
            by_truth.inverse(&q, &qd, &qdd, &mut b);
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} against {b}");
            }
        }
    }

    #[test]
    fn published_puma_friction_comes_from_the_motor() {
        // Corke and Armstrong-Hélouvry: motor 1 turns against its joint and meets 0.395 N·m one way, 0.435 the other.
        let (robot, truth) = simulated("puma-560");
        let (drive, gear) = (&truth.drives[0], 62.6111);
        assert!((drive[COULOMB] + drive[OFFSET] - gear * 0.435).abs() < 1e-9);
        assert!((drive[COULOMB] - drive[OFFSET] - gear * 0.395).abs() < 1e-9);
        // As a term of its own: what the offset stands for in the file is half the difference between the directions.
        let mut directed = DriveParameters::from_iter([(COULOMB, drive[COULOMB])]);
        directed[COULOMB_DIRECTION] = drive[OFFSET];
        for (speed, expected) in [(1.0, gear * 0.435), (-1.0, -gear * 0.395), (0.0, 0.0)] {
            let mut arm = StandardParameters::zero(6);
            arm.drives[0] = directed.clone();
            let (mut tau, mut qd) = ([0.0; 6], [0.0; 6]);
            qd[0] = speed;
            Dynamics::new(&robot.clone().with_gravity(nalgebra::Vector3::zeros()), &arm)
                .inverse(&[0.0; 6], &qd, &[0.0; 6], &mut tau);
            assert!((tau[0] - expected).abs() < 1e-9, "{speed} rad/s: {} N·m", tau[0]);
        }
        assert!((drive[ROTOR] - 200e-6 * gear * gear).abs() < 1e-9);
        assert!((robot.joints()[0].drive.gear - gear).abs() < 1e-12);
    }

    #[test]
    fn published_tx40_sums_what_its_source_sums() {
        let (robot, truth) = simulated("staubli-tx40");
        assert!((0..6).map(|i| robot.is_coupled(i)).eq([false, false, false, false, false, true]));
        // Joint 5 carries its own rotor and that of motor 6.
        assert!((truth.drives[4][ROTOR] + truth.drives[5][ROTOR] - 0.0361).abs() < 1e-15);
        for (joint, gain) in robot.joints().iter().zip([35.24, 32.04, 23.94, 9.05, 15.5, 6.56]) {
            assert!((joint.drive.torque_per_ampere() - gain).abs() < 1e-12, "{}", joint.name);
            assert!((joint.drive.current_noise * gain - 0.05).abs() < 2e-5, "{}", joint.name);
        }
        // At zero the arm stands straight up: 0.32 + 0.225 + 0.225 m to the centre of the wrist.
        let wrist = robot.base().compose(&robot.poses(&[0.0; 6])[5]).translation;
        assert!((wrist - nalgebra::Vector3::new(0.0, 0.035, 0.77)).norm() < 1e-15, "{wrist}");
    }

    #[test]
    fn analytic_planar_arm_stretched_out_holds_its_weight() {
        let (robot, truth) = simulated("planar-2r");
        let (mut tau, rest) = ([0.0; 2], [0.0; 2]);
        Dynamics::new(&robot, &truth).inverse(&rest, &rest, &rest, &mut tau);
        // Link 1: 3 kg at 0.2 m; link 2: 2 kg at 0.4 + 0.15 m; offsets 0.1 and −0.05 N·m.
        assert!((tau[0] - (9.81 * (3.0 * 0.2 + 2.0 * 0.55) + 0.1)).abs() < 1e-14, "{} N·m", tau[0]);
        assert!((tau[1] - (9.81 * 2.0 * 0.15 - 0.05)).abs() < 1e-14, "{} N·m", tau[1]);
    }
}
