//! The robots that the tests share.

use armid::conformance::chains::ChainRecipe;
use armid::model::format::{parse_parameters, parse_robot};
use armid::model::term::ROTOR;
use armid::model::{Robot, StandardParameters, bundled};
use armid::seed::Seed;
use armid::study::truth_text;

use crate::mujoco::MujocoPlant;

/// Every bundled robot with its true parameters.
pub(super) fn bundled_robots() -> Vec<(Robot, StandardParameters)> {
    bundled()
        .iter()
        .map(|entry| {
            let robot = parse_robot(entry.robot).unwrap();
            let truth = parse_parameters(truth_text(entry.name).unwrap(), &robot, true).unwrap().parameters;
            (robot, truth)
        })
        .collect()
}

/// Random chains of one to seven joints: revolute and prismatic, standard and modified, tilted, some coupled.
pub(super) fn chains(count: u64) -> impl Iterator<Item = (Robot, StandardParameters)> {
    (0..count).map(|run| {
        let mut rng = Seed::new(31).stream("chains", run);
        let recipe = ChainRecipe { tilted: true, coupled: run % 3 == 0, ..ChainRecipe::new(1 + run as usize % 7) };
        recipe.draw(&mut rng)
    })
}

/// The parameters without friction and offset.
pub(super) fn frictionless(parameters: &StandardParameters) -> StandardParameters {
    let mut out = parameters.clone();
    for drive in &mut out.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    out
}

pub(super) fn plant(robot: &Robot, parameters: &StandardParameters) -> MujocoPlant {
    MujocoPlant::new(robot, parameters).unwrap_or_else(|fault| panic!("{fault}"))
}

/// The largest difference, NaN where one is NaN.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, |most, d| if d <= most { most } else { d })
}

/// The largest magnitude, at least one.
pub(super) fn size(a: &[f64]) -> f64 {
    a.iter().fold(1.0, |most, x| most.max(x.abs()))
}
