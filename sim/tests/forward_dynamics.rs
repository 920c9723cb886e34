//! The simulator's own equations of motion against the core's, which are solved another way, and against the regressor, which
//! walks along other frames and knows no base parameters.

use armid::conformance::chains::{self, ChainRecipe};
use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::model::Columns;
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid_sim::{AnalyticError, AnalyticPlant, MOST_JOINTS};
use rand::RngExt;

#[test]
fn identity_accelerations_are_those_of_the_articulated_body_algorithm() {
    let seed = Seed::new(2);
    let mut worst: f64 = 0.0;
    for run in 0..160 {
        let mut rng = seed.stream("chains", run);
        let dof = 1 + run as usize % MOST_JOINTS;
        let recipe = ChainRecipe { tilted: true, prismatic: 0.3, ..ChainRecipe::new(dof) };
        let (robot, parameters) = recipe.draw(&mut rng);
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
        for _ in 0..5 {
            let (q, qd, tau) = chains::random_state(&mut rng, dof);
            plant.reset(&q, &qd);
            let (mut own, mut other) = (vec![0.0; dof], vec![0.0; dof]);
            plant.acceleration(&tau, &mut own);
            dynamics.forward_articulated(&q, &qd, &tau, &mut other);
            let size = other.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            for (x, y) in own.iter().zip(&other) {
                worst = worst.max((x - y).abs() / size);
            }
        }
    }
    // Rounding through mass matrices of condition numbers up to 1e4.
    assert!(worst < 1e-11, "{worst:e}");
}

#[test]
fn identity_accelerations_take_the_torque_of_the_regressor() {
    let seed = Seed::new(5);
    let mut worst: f64 = 0.0;
    for run in 0..160 {
        let mut rng = seed.stream("chains", run);
        let dof = 1 + run as usize % MOST_JOINTS;
        let recipe =
            ChainRecipe { tilted: run % 2 == 0, coupled: run % 3 == 0, prismatic: 0.3, ..ChainRecipe::new(dof) };
        let (robot, parameters) = recipe.draw(&mut rng);
        let columns = Columns::RIGID_ROTOR_FRICTION.with_terms_of(&parameters);
        let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
        let values = parameters.vector(&robot, columns);
        let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
        let mut y = vec![0.0; dof * regressor.cols()];
        for _ in 0..5 {
            let (q, qd, tau) = chains::random_state(&mut rng, dof);
            plant.reset(&q, &qd);
            let mut qdd = vec![0.0; dof];
            plant.acceleration(&tau, &mut qdd);
            regressor.evaluate(&q, &qd, &qdd, &mut y);
            let size = qdd.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            for (row, tau) in y.chunks_exact(values.len()).zip(&tau) {
                let needed: f64 = row.iter().zip(&values).map(|(y, value)| y * value).sum();
                worst = worst.max((needed - tau).abs() / size);
            }
        }
    }
    // Torques of some hundred N·m and their rounding.
    assert!(worst < 1e-11, "{worst:e}");
}

#[test]
fn identity_coupled_accelerations_undo_inverse_dynamics() {
    // The articulated body algorithm does not cover coupled rotors; Newton-Euler does.
    let seed = Seed::new(3);
    let mut worst: f64 = 0.0;
    for run in 0..40 {
        let mut rng = seed.stream("chains", run);
        let dof = 2 + run as usize % 5;
        let recipe = ChainRecipe { coupled: true, ..ChainRecipe::new(dof) };
        let (robot, parameters) = recipe.draw(&mut rng);
        let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
        let (q, qd, qdd) = chains::random_state(&mut rng, dof);
        let (mut tau, mut own) = (vec![0.0; dof], vec![0.0; dof]);
        Dynamics::new(&robot, &parameters).inverse(&q, &qd, &qdd, &mut tau);
        plant.reset(&q, &qd);
        plant.acceleration(&tau, &mut own);
        for (x, y) in own.iter().zip(&qdd) {
            worst = worst.max((x - y).abs());
        }
    }
    assert!(worst < 1e-10, "{worst:e}");
}

#[test]
fn what_cannot_be_simulated_is_named() {
    let mut rng = Seed::new(4).stream("chains", 0);
    let (robot, parameters) = chains::random_robot(&mut rng, MOST_JOINTS + 1);
    assert_eq!(AnalyticPlant::new(&robot, &parameters).unwrap_err(), AnalyticError::Dof { dof: MOST_JOINTS + 1 });
    let (small, _) = chains::random_robot(&mut rng, 2);
    let fault = AnalyticPlant::new(&small, &parameters).unwrap_err();
    assert_eq!(fault, AnalyticError::Parameters { found: MOST_JOINTS + 1, expected: 2 });
    let _: f64 = rng.random();
}
