//! Every torque term of the list in every engine: what is simulated is what the regressor says.

use armid::conformance::plant_term_laws::{self, TermTolerance};
use armid::model::term::Term;
use armid_sim::Engine;

fn every_term_obeys(engine: Engine, tolerance: &TermTolerance) {
    for &term in Term::ALL {
        plant_term_laws::check(term, tolerance, |robot, parameters| {
            engine.plant(robot, parameters).unwrap_or_else(|fault| panic!("{}: {fault}", term.symbol()))
        })
        .unwrap_or_else(|broken| panic!("{} in {}: {broken}", term.symbol(), engine.name()));
    }
}

#[test]
fn identity_every_term_of_the_list_is_in_the_analytic_plant_what_the_regressor_says() {
    every_term_obeys(Engine::Analytic, &TermTolerance::FOURTH_ORDER);
}

#[test]
fn identity_every_term_of_the_list_is_in_rapier_what_the_regressor_says() {
    every_term_obeys(Engine::Rapier, &TermTolerance::FIRST_ORDER);
}

#[test]
fn identity_every_term_of_the_list_is_in_mujoco_what_the_regressor_says() {
    every_term_obeys(Engine::Mujoco, &TermTolerance::FOURTH_ORDER);
}
