//! MJCF for other tools, read back by the library's own reader.

use armid::conformance::chains::random_state;
use armid::dynamics::Dynamics;
use armid::model::bundled;
use armid::model::format::{ChainEnds, parse_mjcf, parse_nominal, parse_robot};
use armid::model::term::{COULOMB, ROTOR, VISCOUS};
use armid::seed::Seed;

#[test]
fn identity_every_bundled_robot_reads_back_with_its_rotors_coupled_or_not() {
    let mut coupled = 0;
    for entry in bundled() {
        let robot = parse_robot(entry.robot).unwrap();
        let mut parameters = parse_nominal(entry.nominal, &robot).unwrap().parameters;
        for drive in &mut parameters.drives {
            drive[ROTOR] = drive[ROTOR].max(0.01);
        }
        let text = armid_sim::mjcf_for_exchange(&robot, &parameters, "a test").unwrap();
        let mut read =
            parse_mjcf(&text, &ChainEnds::default()).unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
        for (found, expected) in read.parameters.drives.iter_mut().zip(&mut parameters.drives) {
            assert_eq!((found[VISCOUS], found[COULOMB]), (expected[VISCOUS], expected[COULOMB]), "{}", entry.name);
            // Friction acts at the joints alike; what is compared is links and rotors.
            (*found, *expected) = (found.only(|term| term == ROTOR), expected.only(|term| term == ROTOR));
        }
        coupled += usize::from(robot.coupling().is_some());
        assert_eq!(read.robot.coupling().is_some(), robot.coupling().is_some(), "{}", entry.name);
        let n = robot.dof();
        let (mut ours, mut theirs) = (Dynamics::new(&robot, &parameters), Dynamics::new(&read.robot, &read.parameters));
        let mut rng = Seed::new(3).stream("read back", 0);
        for _ in 0..50 {
            let (q, qd, qdd) = random_state(&mut rng, n);
            let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
            ours.inverse(&q, &qd, &qdd, &mut a);
            theirs.inverse(&q, &qd, &qdd, &mut b);
            let size = a.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() < 1e-9 * size, "{}: {a} {b}", entry.name);
            }
        }
    }
    assert!(coupled > 0, "no bundled robot has coupled motors");
}
