//! The laws of plants and arms on every bundled robot and on random chains.
#![allow(clippy::unwrap_used, reason = "a test panics")]

use armid::conformance::chains::ChainRecipe;
use armid::conformance::plant_laws::{self, PlantTolerance};
use armid::experiment::Plant;
use armid::model::format::{parse_parameters, parse_robot};
use armid::model::{Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::study::truth_text;
use armid_sim::{AnalyticPlant, RapierPlant};

/// Checks a kind of plant on every bundled robot and on random chains.
fn obeys<P: Plant>(tolerance: &PlantTolerance, plant: fn(&Robot, &StandardParameters) -> P) {
    for entry in bundled() {
        let robot = parse_robot(entry.robot).unwrap();
        let truth = parse_parameters(truth_text(entry.name).unwrap(), &robot, true).unwrap().parameters;
        plant_laws::check(&robot, &truth, tolerance, plant).unwrap_or_else(|broken| panic!("{}: {broken}", entry.name));
    }
    for run in 0..12 {
        let mut rng = Seed::new(5).stream("chains", run);
        let recipe = ChainRecipe { tilted: true, coupled: run % 3 == 0, ..ChainRecipe::new(1 + run as usize % 7) };
        let (robot, parameters) = recipe.draw(&mut rng);
        plant_laws::check(&robot, &parameters, tolerance, plant)
            .unwrap_or_else(|broken| panic!("chain {run}: {broken}"));
    }
}

#[test]
fn identity_the_analytic_plant_obeys_the_laws_of_plants() {
    obeys(&PlantTolerance::FOURTH_ORDER, |robot, parameters| AnalyticPlant::new(robot, parameters).unwrap());
}

#[test]
fn identity_the_engine_rapier_obeys_the_laws_of_plants() {
    obeys(&PlantTolerance::FIRST_ORDER, |robot, parameters| RapierPlant::new(robot, parameters).unwrap());
}
