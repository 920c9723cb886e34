//! The three methods agree, and `Y φ = Y_b β`.

use nalgebra::Vector3;
use rand::RngExt;

use crate::base::*;
use crate::conformance::chains::ChainRecipe;
use crate::model::{Columns, Robot};
use crate::seed::Seed;

fn compare(robot: &Robot, columns: Columns, what: &str) {
    let [paper, qr, structural] = Method::ALL.map(|m| reduce(robot, columns, m, Seed::new(3)).unwrap());
    for (name, other) in [("paper", &paper), ("qr", &qr)] {
        assert_eq!(other.kept, structural.kept, "{what}: {name} {:?} {:?}", other.names(), structural.names());
        assert_eq!(other.categories, structural.categories, "{what}: {name}");
        let e = (&other.k - &structural.k).amax();
        assert!(e < 1e-9 * structural.k.amax().max(1.0), "{what} {name} {e:e} {:e}", structural.k.amax());
    }
}

#[test]
fn identity_three_methods_on_random_chains() {
    let mut rng = Seed::new(5).stream("chains", 0);
    for run in 0..140_u64 {
        let mut recipe = ChainRecipe::new(1 + run as usize % 7);
        recipe.prismatic = [0.0, 0.25, 0.6, 1.0][run as usize % 4];
        recipe.coupled = run % 3 == 0;
        recipe.tilted = run % 5 == 0;
        let (mut robot, _) = recipe.draw(&mut rng);
        if run % 5 == 1 {
            robot = robot.with_gravity(Vector3::zeros());
        }
        if run % 5 == 2 {
            robot = robot.with_gravity(Vector3::from_fn(|_, _| rng.random_range(-5.0..5.0)));
        }
        let columns = Columns::ALL[run as usize % 3];
        compare(&robot, columns, &format!("run {run} {columns:?} {recipe:?}"));
    }
}
