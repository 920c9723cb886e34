//! Motion over time: order of convergence, agreement with the other plant, friction that is stiff.

use armid::conformance::plant_laws::{self, PlantTolerance};
use armid::experiment::{Plant, PlantError};
use armid::model::term::{COULOMB, OFFSET, VISCOUS};
use armid::model::{Robot, StandardParameters};

use super::robots::{self, bundled_robots, distance, frictionless};
use crate::{AnalyticPlant, MujocoPlant, MujocoScheme};

/// The A460 with its true parameters.
fn a460() -> (Robot, StandardParameters) {
    bundled_robots().into_iter().find(|(robot, _)| robot.name().contains("a460")).expect("it is bundled")
}

/// A state far from rest: n positions, then n velocities.
fn start(n: usize) -> Vec<f64> {
    (0..n).map(|i| 0.3 - 0.1 * i as f64).chain((0..n).map(|i| 0.2 * (i as f64 - 1.5))).collect()
}

/// Where a plant is after `time` seconds in steps of `dt`, under torques `tau(t)` held over each; positions, then
/// velocities.
fn drive(plant: &mut dyn Plant, time: f64, dt: f64, tau: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let n = plant.dof();
    let start = start(n);
    plant.reset(&start[..n], &start[n..]);
    for k in 0..(time / dt).round() as usize {
        plant.step(&tau(k as f64 * dt), dt).unwrap();
    }
    let (q, qd) = plant.state();
    q.iter().chain(qd).copied().collect()
}

/// The motion without any torque.
fn fall(plant: &mut dyn Plant, time: f64, dt: f64) -> Vec<f64> {
    let n = plant.dof();
    drive(plant, time, dt, |_| vec![0.0; n])
}

/// Order of convergence `log₂(e(h) / e(h/2))` over 0.2 s, for three halvings from `h`.
fn orders(robot: &Robot, parameters: &StandardParameters, scheme: MujocoScheme, h: f64) -> [f64; 3] {
    let time = 0.2;
    let exact = fall(&mut robots::plant(robot, parameters), time, h / 128.0);
    let plant = robots::plant(robot, parameters).with_scheme(scheme);
    let error = |k: i32| distance(&exact, &fall(&mut plant.clone(), time, h / f64::from(1 << k)));
    let errors = [error(0), error(1), error(2), error(3)];
    println!("{}, {scheme:?}, h = {h}: errors {:?}", robot.name(), errors.map(|e| format!("{e:.1e}")));
    std::array::from_fn(|k| libm::log2(errors[k] / errors[k + 1]))
}

/// Viscous friction, and Coulomb friction smooth enough to be resolved by the steps of the test.
fn gently_rubbed() -> (Robot, StandardParameters) {
    let (robot, parameters) = a460();
    (robot.with_joints(|joint| joint.drive.coulomb_velocity = 2.0).unwrap(), parameters)
}

#[test]
fn analytic_orders_of_convergence_without_friction() {
    let (robot, parameters) = a460();
    let parameters = frictionless(&parameters);
    for (scheme, expected) in
        [(MujocoScheme::Stages, 4.0), (MujocoScheme::HeldRungeKutta, 4.0), (MujocoScheme::HeldEuler, 1.0)]
    {
        let found = orders(&robot, &parameters, scheme, 0.02);
        // The next power of h is still seen at the first halvings.
        assert!(found.iter().all(|order| (order - expected).abs() < 0.25), "{scheme:?}: orders {found:.2?}");
    }
}

#[test]
fn analytic_orders_of_convergence_with_smooth_friction() {
    let (robot, parameters) = gently_rubbed();
    for (scheme, expected) in
        [(MujocoScheme::Stages, 4.0), (MujocoScheme::HeldRungeKutta, 1.0), (MujocoScheme::HeldEuler, 1.0)]
    {
        // A longer step would be divided: friction is still the stiffest there is.
        let found = orders(&robot, &parameters, scheme, 0.004);
        assert!(found.iter().all(|order| (order - expected).abs() < 0.25), "{scheme:?}: orders {found:.2?}");
    }
}

/// The largest difference between the two plants within two seconds in steps of `dt`, and the longest way of a joint.
fn apart(robot: &Robot, parameters: &StandardParameters, dt: f64, tau: &dyn Fn(f64) -> Vec<f64>) -> (f64, f64) {
    let n = robot.dof();
    let mut own = AnalyticPlant::new(robot, parameters).unwrap();
    let mut other = robots::plant(robot, parameters);
    let start = start(n);
    own.reset(&start[..n], &start[n..]);
    other.reset(&start[..n], &start[n..]);
    let (mut worst, mut moved): (f64, f64) = (0.0, 0.0);
    for k in 0..(2.0 / dt).round() as usize {
        let tau = tau(k as f64 * dt);
        own.step(&tau, dt).unwrap();
        other.step(&tau, dt).unwrap();
        let ((q, qd), (other_q, other_qd)) = (own.state(), other.state());
        worst = worst.max(distance(q, other_q)).max(distance(qd, other_qd));
        moved = moved.max(distance(q, &start[..n]));
    }
    (worst, moved)
}

#[test]
fn identity_two_seconds_of_free_motion_are_those_of_the_analytic_plant() {
    for (robot, parameters) in bundled_robots() {
        let n = robot.dof();
        let (error, moved) = apart(&robot, &frictionless(&parameters), 1e-3, &|_| vec![0.0; n]);
        println!("{}, free: {error:.1e} rad, rad/s apart after {moved:.2} rad", robot.name());
        // The same method on the same equations: rounding is left, multiplied by how fast motions diverge.
        assert!(error < 1e-11 && moved > 1.0, "{}: {error:.1e} apart after {moved:.2}", robot.name());
    }
}

#[test]
fn identity_two_seconds_through_standstill_are_those_of_the_analytic_plant() {
    for (robot, parameters) in bundled_robots() {
        // Torques held for a millisecond that reverse every joint again and again.
        let shake = |t: f64| {
            let t = 1e-3 * (1e3 * t + 1e-6).floor();
            let swing = |i: usize| libm::sin(9.0 * t + i as f64);
            let friction = |i: usize| 3.0 * (parameters.drives[i][COULOMB] + parameters.drives[i][VISCOUS]);
            (0..robot.dof()).map(|i| friction(i) * swing(i)).collect()
        };
        let (whole, moved) = apart(&robot, &parameters, 1e-3, &shake);
        let (fine, _) = apart(&robot, &parameters, 1e-3 / 32.0, &shake);
        println!("{}, shaken: {whole:.1e} rad, rad/s apart, {fine:.1e} at dt/32, after {moved:.2} rad", robot.name());
        // Each plant divides a step by a rule of its own where friction is stiff; the difference goes with the step.
        assert!(whole < 1e-3 && fine < 1e-11 && moved > 0.1, "{}: {whole:.1e}, {fine:.1e}, {moved:.2}", robot.name());
    }
}

#[test]
fn identity_the_plant_obeys_the_laws_of_plants() {
    for (robot, parameters) in bundled_robots().into_iter().chain(robots::chains(12)) {
        plant_laws::check(&robot, &parameters, &PlantTolerance::FOURTH_ORDER, robots::plant)
            .unwrap_or_else(|broken| panic!("{}: {broken}", robot.name()));
    }
}

#[test]
fn identity_substeps_are_steps() {
    let (robot, parameters) = a460();
    let mut whole = robots::plant(&robot, &parameters).with_substeps(4);
    let mut parts = robots::plant(&robot, &parameters);
    assert_eq!(fall(&mut whole, 0.1, 4e-3), fall(&mut parts, 0.1, 1e-3));
}

#[test]
fn a_step_too_long_for_friction_is_divided() {
    // An explicit step of 1 ms would explode at rates of thousands per second; every scheme must come to rest.
    let (robot, parameters) = a460();
    let robot = robot.with_joints(|joint| joint.drive.coulomb_velocity = 1e-3).unwrap().with_gravity(nalgebra::zero());
    for scheme in [MujocoScheme::Stages, MujocoScheme::HeldRungeKutta, MujocoScheme::HeldEuler] {
        let mut parameters = parameters.clone();
        parameters.drives.iter_mut().for_each(|drive| drive[OFFSET] = 0.0);
        let mut plant = robots::plant(&robot, &parameters).with_scheme(scheme);
        let end = fall(&mut plant, 2.0, 1e-3);
        assert!(end[robot.dof()..].iter().all(|v| v.abs() < 1e-9), "{scheme:?}: {end:?}");
    }
}

#[test]
fn a_motion_that_is_no_number_ends_in_an_error() {
    let (robot, parameters) = a460();
    let mut plant: MujocoPlant = robots::plant(&robot, &parameters);
    let fault = (0..10).find_map(|_| plant.step(&[f64::NAN; 6], 1e-3).err());
    assert!(matches!(fault, Some(PlantError::NotFinite { joint: 1, .. })), "{fault:?}");
    plant.reset(&[0.0; 6], &[0.0; 6]);
    plant.step(&[0.0; 6], 1e-3).unwrap();
    let fault = (0..10).find_map(|_| plant.step(&[1e300; 6], 1e-3).err());
    assert!(fault.is_some());
}
