//! The closed-form regrouping of M. Gautier and W. Khalil, "Direct calculation of minimum set of inertial parameters
//! of serial robots", IEEE Trans. Robotics and Automation 6(3), 1990 (also W. Khalil, E. Dombre, *Modeling,
//! Identification and Control of Robots*, 2002, ch. 9): rules by hand for modified DH, an oracle that shares nothing
//! with the three methods.

use nalgebra::{DVector, Vector3};
use rand::RngExt;

use super::chains::{bundled_robots, parts};
use crate::base::{Method, reduce};
use crate::chains::ChainRecipe;
use crate::model::{Columns, DhConvention, ParameterKind, Robot};
use crate::seed::Seed;

/// Moves YY, MZ and M of each link of a revolute chain to the link before it, outermost first; φ in our order.
fn regroup(robot: &Robot, phi: &DVector<f64>) -> DVector<f64> {
    use ParameterKind::{Ixx, Ixy, Ixz, Iyy, Iyz, Izz, M, Mcx, Mcy, Mcz};
    let mut b = phi.clone();
    for j in (0..robot.dof()).rev() {
        let (_, row) = robot.joints()[j].dh.unwrap();
        let (d, r) = (row.a, row.d);
        let (s, c) = row.alpha_deg.to_radians().sin_cos();
        let here = |kind: ParameterKind| 10 * j + kind.link_place().unwrap();
        let (yy, mz, m) = (b[here(Iyy)], b[here(Mcz)], b[here(M)]);
        b[here(Ixx)] -= yy;
        if j > 0 {
            let before = |kind: ParameterKind| 10 * (j - 1) + kind.link_place().unwrap();
            b[before(Ixx)] += yy + 2.0 * r * mz + r * r * m;
            b[before(Ixy)] += d * s * mz + d * r * s * m;
            b[before(Ixz)] += -d * c * mz - d * r * c * m;
            b[before(Iyy)] += c * c * yy + 2.0 * r * c * c * mz + (d * d + r * r * c * c) * m;
            b[before(Iyz)] += c * s * yy + 2.0 * r * c * s * mz + r * r * c * s * m;
            b[before(Izz)] += s * s * yy + 2.0 * r * s * s * mz + (d * d + r * r * s * s) * m;
            b[before(Mcx)] += d * m;
            b[before(Mcy)] += -s * mz - r * s * m;
            b[before(Mcz)] += c * mz + r * c * m;
            b[before(M)] += m;
        }
    }
    b
}

fn assert_regrouped(robot: &Robot, expected_rank: usize) {
    let mut rng = Seed::new(4).stream("parameters", 0);
    let base = reduce(robot, Columns::RIGID, Method::Structural, Seed::new(1)).unwrap();
    let phi = DVector::from_fn(10 * robot.dof(), |_, _| rng.random_range(-1.0..1.0));
    let (beta, regrouped) = (base.beta(&phi), regroup(robot, &phi));
    assert_eq!(base.rank(), expected_rank, "{:?}", base.names());
    for (&j, value) in base.kept.iter().zip(&beta) {
        let kind = base.parameters[j].kind;
        assert!(!matches!(kind, ParameterKind::Iyy | ParameterKind::Mcz | ParameterKind::M), "{}", base.parameters[j]);
        // Some ten additions of numbers up to the square of ten lengths.
        assert!((value - regrouped[j]).abs() < 1e-12, "{}: {value} {}", base.parameters[j], regrouped[j]);
    }
}

#[test]
fn published_regrouping_of_the_tx40() {
    let robot = bundled_robots().into_iter().find(|robot| robot.name() == "staubli-tx40").unwrap();
    assert!(robot.joints().iter().all(|joint| matches!(joint.dh, Some((DhConvention::Modified, _)))));
    assert_regrouped(&robot, 36);
}

#[test]
fn published_regrouping_of_oblique_revolute_chains() {
    let mut rng = Seed::new(21).stream("oblique chains", 0);
    for dof in 1..8 {
        let mut recipe = ChainRecipe::new(dof);
        (recipe.prismatic, recipe.convention) = (0.0, Some(DhConvention::Modified));
        let (robot, _) = recipe.draw(&mut rng);
        // Neither parallel nor perpendicular axes, no vanishing length: the general case, of seven parameters per link
        // and three of the first, gravity being in general position too.
        let mut spec = parts(&robot);
        for joint in &mut spec.joints {
            let (convention, row) = joint.dh.as_mut().unwrap();
            row.alpha_deg = rng.random_range(20.0..70.0);
            (row.a, row.d) = (rng.random_range(0.1..0.5), rng.random_range(0.1..0.5));
            (joint.before, joint.after) = row.placements(*convention);
        }
        let robot = Robot::new(spec).unwrap().with_gravity(Vector3::new(3.0, -4.0, 8.0));
        assert_regrouped(&robot, 7 * dof - 4);
    }
}
