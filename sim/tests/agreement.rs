//! The certificate on the A460 along Table I, on the PUMA 560 and on a random arm.
#![allow(clippy::unwrap_used, reason = "a test panics")]

use armid::conformance::chains::ChainRecipe;
use armid::experiment::ExperimentPlan;
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::{Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid_sim::Engine;
use armid_sim::agreement::{Agreement, Case, agree, safe_motion};

fn robot(name: &str) -> (Robot, StandardParameters, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = parse_nominal(entry.nominal, &robot).unwrap().parameters;
    let truth = parse_parameters(truth_text(name).unwrap(), &robot, true).unwrap().parameters;
    (robot, nominal, truth)
}

/// The experiment without what does not count, so that the test is short.
fn plan(trajectory: armid::trajectory::FourierTrajectory) -> ExperimentPlan {
    ExperimentPlan { settle_s: 0.1, discarded_periods: 0, ..ExperimentPlan::new(trajectory) }
}

fn certified(case: &Case<'_>) -> Agreement {
    let agreement = agree(case, &Engine::ALL);
    assert!(agreement.absent.is_empty(), "{:?}", agreement.absent);
    assert!(agreement.holds(), "{:#?}\n{agreement:#?}", agreement.breaches());
    assert_eq!(agreement.engines.len(), Engine::ALL.len());
    agreement
}

#[test]
fn identity_engines_agree_on_the_a460_along_table_one() {
    let (robot, nominal, truth) = robot("crs-a460");
    let plan = plan(table_one::corrected());
    let case = Case { robot: &robot, nominal: &nominal, truth: &truth, plan: &plan, seed: Seed::new(1) };
    let agreement = certified(&case);
    let text = serde_json::to_string(&agreement).unwrap();
    assert_eq!(serde_json::from_str::<Agreement>(&text).unwrap(), agreement);
}

#[test]
fn identity_engines_agree_on_the_puma_560() {
    let (robot, nominal, truth) = robot("puma-560");
    let plan = plan(safe_motion(&robot, &nominal, Seed::new(1)).unwrap());
    certified(&Case { robot: &robot, nominal: &nominal, truth: &truth, plan: &plan, seed: Seed::new(1) });
}

#[test]
fn identity_engines_agree_on_a_random_arm_with_coupled_motors() {
    let recipe = ChainRecipe { coupled: true, tilted: true, ..ChainRecipe::new(5) };
    let (robot, truth) = recipe.draw(&mut Seed::new(3).stream("chains", 0));
    let plan = plan(safe_motion(&robot, &truth, Seed::new(1)).unwrap());
    certified(&Case { robot: &robot, nominal: &truth, truth: &truth, plan: &plan, seed: Seed::new(1) });
}
