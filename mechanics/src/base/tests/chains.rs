//! The robots that the laws are shown on.

use nalgebra::Vector3;
use rand::RngExt;

use crate::chains::ChainRecipe;
use crate::model::format::parse_robot;
use crate::model::{Columns, Robot, RobotSpec, bundled};
use crate::seed::Seed;

/// Every bundled robot.
pub(super) fn bundled_robots() -> Vec<Robot> {
    bundled().iter().map(|entry| parse_robot(entry.robot).unwrap()).collect()
}

/// The CRS A460.
pub(super) fn a460() -> Robot {
    bundled_robots().into_iter().find(|robot| robot.name() == "crs-a460").unwrap()
}

/// Random chains of 1 to 7 joints: none to all of them prismatic, motors coupled or not, gravity along the first
/// axis, along any direction, or none; each with a choice of columns.
pub(super) fn random_chains(count: usize) -> Vec<(Robot, Columns)> {
    let mut rng = Seed::new(5).stream("chains for base parameters", 0);
    (0..count)
        .map(|run| {
            let mut recipe = ChainRecipe::new(1 + run % 7);
            recipe.prismatic = [0.0, 0.25, 0.6, 1.0][run % 4];
            recipe.coupled = run % 3 == 0;
            let (robot, _) = recipe.draw(&mut rng);
            let gravity = match run % 5 {
                0 => Vector3::zeros(),
                1 | 2 => Vector3::from_fn(|_, _| rng.random_range(-8.0..8.0)),
                3 => robot.joints()[0].before.rotation.column(2) * 9.81,
                _ => Vector3::new(0.0, 0.0, -9.81),
            };
            (robot.with_gravity(gravity), Columns::ALL[run % 3])
        })
        .collect()
}

/// The parts of a robot, to be put together another way.
pub(super) fn parts(robot: &Robot) -> RobotSpec {
    RobotSpec {
        name: robot.name().to_owned(),
        gravity: robot.base().rotation * robot.gravity(),
        base: *robot.base(),
        joints: robot.joints().to_vec(),
        coupling: robot.coupling().cloned(),
        ..RobotSpec::default()
    }
}

/// The arm with each length of its DH table multiplied by what `factor` gives.
pub(super) fn relengthened(robot: &Robot, mut factor: impl FnMut() -> f64) -> Robot {
    let mut spec = parts(robot);
    for joint in &mut spec.joints {
        let (convention, row) = joint.dh.as_mut().expect("a robot with a DH table");
        row.a *= factor();
        row.d *= factor();
        (joint.before, joint.after) = row.placements(*convention);
    }
    Robot::new(spec).unwrap()
}
