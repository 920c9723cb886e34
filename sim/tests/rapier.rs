//! The engine rapier against the core's equations and the analytic plant.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::dynamics::TermError;
use armid::model::term::ROTOR;
use std::num::NonZeroU32;

use armid::conformance::chains::{self, ChainRecipe};
use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::model::{Robot, StandardParameters};
use armid::seed::Seed;
use armid::spatial::{Inertia, InertiaError};
use armid_sim::{AnalyticPlant, RapierError, RapierPlant};
use nalgebra::{Matrix3, Vector3};

/// Chains of both joint kinds and DH conventions, every third with coupled motors, on tilted bases.
fn chain(run: u64) -> (Robot, StandardParameters) {
    let mut rng = Seed::new(6).stream("chains", run);
    let dof = 1 + run as usize % 7;
    ChainRecipe { tilted: true, coupled: run.is_multiple_of(3), prismatic: 0.3, ..ChainRecipe::new(dof) }.draw(&mut rng)
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (x, y)| (x - y).abs().max(most))
}

#[test]
fn identity_mass_matrix_is_the_core_s() {
    let mut worst: f64 = 0.0;
    for run in 0..42 {
        let (robot, parameters) = chain(run);
        let mut plant = RapierPlant::new(&robot, &parameters).unwrap();
        let (q, qd, _) = chains::random_state(&mut Seed::new(7).stream("states", run), robot.dof());
        plant.reset(&q, &qd);
        let own = Dynamics::new(&robot, &parameters).mass_matrix(&q);
        worst = worst.max((plant.mass_matrix() - &own).amax() / own.amax());
    }
    // Rounding of quaternions, principal axes and factors.
    assert!(worst < 1e-13, "{worst:e}");
}

#[test]
fn identity_accelerations_are_the_core_s() {
    let mut worst: f64 = 0.0;
    for run in 0..42 {
        let (robot, parameters) = chain(run);
        let n = robot.dof();
        let mut plant = RapierPlant::new(&robot, &parameters).unwrap();
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let (q, qd, qdd) = chains::random_state(&mut Seed::new(8).stream("states", run), n);
        let (mut tau, mut found) = (vec![0.0; n], vec![0.0; n]);
        dynamics.inverse(&q, &qd, &qdd, &mut tau);
        plant.reset(&q, &qd);
        plant.acceleration(&tau, &mut found);
        assert_eq!(plant.state(), (&q[..], &qd[..]));
        worst = worst.max(largest(&found, &qdd));
    }
    // What the engine treats implicitly moves 10 rad/s² by their rate of change times the step of 1e-12 s.
    assert!(worst < 1e-9, "{worst:e}");
}

/// Largest difference of position to the analytic plant after `time` s, from a random state under a constant torque.
fn difference(robot: &Robot, parameters: &StandardParameters, substeps: u32, dt: f64, time: f64) -> f64 {
    let n = robot.dof();
    let (q, qd, qdd) = chains::random_state(&mut Seed::new(9).stream("states", 0), n);
    let mut tau = vec![0.0; n];
    Dynamics::new(robot, parameters).inverse(&q, &qd, &qdd, &mut tau);
    let mut own = AnalyticPlant::new(robot, parameters).unwrap();
    let mut other = RapierPlant::new(robot, parameters).unwrap().with_substeps(NonZeroU32::new(substeps).unwrap());
    own.reset(&q, &qd);
    other.reset(&q, &qd);
    let mut most: f64 = 0.0;
    for _ in 0..(time / dt).round() as usize {
        own.step(&tau, dt).unwrap();
        other.step(&tau, dt).unwrap();
        most = most.max(largest(own.state().0, other.state().0));
    }
    most
}

/// Order of convergence over 0.1 s from steps of 0.25 ms down to 0.0625 ms, and the difference at 0.25 ms.
fn order(robot: &Robot, parameters: &StandardParameters) -> (f64, f64) {
    let [coarse, fine] = [4, 16].map(|substeps| difference(robot, parameters, substeps, 1e-3, 0.1));
    (0.5 * libm::log2(coarse / fine), coarse)
}

#[test]
fn identity_free_motion_converges_to_the_analytic_plant_with_order_one() {
    for run in 0..21 {
        let (robot, mut parameters) = chain(run);
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| term == ROTOR);
        }
        let (order, error) = order(&robot, &parameters);
        // Measured 0.9988 to 1.0006, and 1.5e-4 at most: t/2 · h · 10 rad/s² is 1.25e-4.
        assert!((order - 1.0).abs() < 5e-3, "chain {run}: order {order}");
        assert!(error < 2e-4, "chain {run}: {error:e}");
    }
}

#[test]
fn identity_motion_with_friction_and_coupled_motors_converges_to_the_analytic_plant() {
    for run in 0..21 {
        let (robot, parameters) = chain(run);
        let (order, error) = order(&robot, &parameters);
        // The same: implicit friction costs nothing where velocity does not turn.
        assert!((order - 1.0).abs() < 5e-3, "chain {run}: order {order}");
        assert!(error < 2e-4, "chain {run}: {error:e}");
    }
}

#[test]
fn what_cannot_be_simulated_is_named() {
    let (robot, parameters) = chain(5);
    let (_, other) = chain(6);
    let fault = RapierPlant::new(&robot, &other).unwrap_err();
    assert_eq!(fault, RapierError::Parameters { found: other.links.len(), expected: robot.dof() });
    let mut flat = parameters.clone();
    flat.links[1] = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0)));
    let fault = RapierPlant::new(&robot, &flat).unwrap_err();
    assert!(matches!(fault, RapierError::Link { link: 2, fault: InertiaError::NotPositiveDefinite { eigenvalue } }
            if (eigenvalue + 0.5).abs() < 1e-12));
    assert_eq!(
        fault.to_string(),
        "link 2: its pseudo-inertia has the eigenvalue -5.000e-1, expected all four above zero"
    );
    let jumping = robot.clone().with_joints(|joint| joint.drive.coulomb_velocity = 0.0).unwrap();
    assert!(matches!(RapierPlant::new(&jumping, &parameters), Err(RapierError::Term(TermError::Jump { .. }))));
    let mut light = parameters.clone();
    light.drives[0][ROTOR] = -0.1;
    assert!(matches!(RapierPlant::new(&robot, &light), Err(RapierError::Rotor { .. })));
}
