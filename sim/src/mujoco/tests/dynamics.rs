//! MuJoCo's inverse and forward dynamics against Newton–Euler.

use armid::conformance::chains;
use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::seed::Seed;

use super::robots::{self, bundled_robots, distance, frictionless, size};
use crate::mujoco::MujocoModel;

/// MuJoCo turns axes into unit quaternions and diagonalises each inertia, both to about 1e-15; sums of some ten links
/// with cancelling parts lose two digits of that. Measured: 3e-14.
const INVERSE: f64 = 1e-12;
/// Tolerance of forward dynamics, times the condition number of the mass matrix, up to 1e4 on the chains. Measured: 3e-12.
const FORWARD: f64 = 1e-9;

#[test]
fn mujoco_inverse_dynamics_are_those_of_newton_and_euler() {
    let mut worst: f64 = 0.0;
    for (run, (robot, parameters)) in bundled_robots().into_iter().chain(robots::chains(60)).enumerate() {
        let n = robot.dof();
        let parameters = frictionless(&parameters);
        let mut model = MujocoModel::new(&robot, &parameters).unwrap_or_else(|fault| panic!("{fault}"));
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let mut rng = Seed::new(32).stream("states", run as u64);
        for _ in 0..20 {
            let (q, qd, qdd) = chains::random_state(&mut rng, n);
            let (mut other, mut own) = (vec![0.0; n], vec![0.0; n]);
            model.inverse(&q, &qd, &qdd, &mut other);
            dynamics.inverse(&q, &qd, &qdd, &mut own);
            worst = worst.max(distance(&own, &other) / size(&own));
            assert!(worst < INVERSE, "{}: {other:?}, expected {own:?}", robot.name());
        }
    }
    println!("mj_inverse against Newton–Euler: {worst:.1e} relative");
}

#[test]
fn mujoco_accelerations_are_those_of_newton_and_euler() {
    let mut worst: f64 = 0.0;
    for (run, (robot, parameters)) in bundled_robots().into_iter().chain(robots::chains(60)).enumerate() {
        let n = robot.dof();
        let mut plant = robots::plant(&robot, &parameters);
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let mut rng = Seed::new(33).stream("states", run as u64);
        for _ in 0..20 {
            let (q, qd, qdd) = chains::random_state(&mut rng, n);
            let (mut tau, mut found) = (vec![0.0; n], vec![0.0; n]);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            plant.reset(&q, &qd);
            plant.acceleration(&tau, &mut found);
            worst = worst.max(distance(&found, &qdd) / size(&qdd));
            assert!(worst < FORWARD, "{}: {found:?}, expected {qdd:?}", robot.name());
        }
    }
    println!("accelerations against Newton–Euler: {worst:.1e} relative");
}

#[test]
fn identity_inverse_dynamics_leave_the_state_alone() {
    let (robot, parameters) = bundled_robots().swap_remove(0);
    let n = robot.dof();
    let mut model = MujocoModel::new(&robot, &parameters).unwrap_or_else(|fault| panic!("{fault}"));
    let (q, qd, mut tau) = (vec![0.1; n], vec![0.2; n], vec![0.0; n]);
    model.set_state(&q, &qd);
    let before = model.forward().to_vec();
    model.inverse(&vec![0.7; n], &vec![-0.3; n], &vec![1.0; n], &mut tau);
    assert_eq!(model.state(), (&q[..], &qd[..]));
    assert_eq!(model.forward(), before);
    // A copy goes on where the original is.
    let mut copy = model.clone();
    assert_eq!(copy.forward(), before);
}
