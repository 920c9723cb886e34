//! What one given motion reveals.

use rand::RngExt;

use super::chains::a460;
use super::formulas::evaluated;
use crate::base::{BaseError, Category, Method, reduce, reduce_on};
use crate::chains::planar_2r;
use crate::dynamics::States;
use crate::linalg::product;
use crate::model::{Columns, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;

/// 200 random states in which each joint moves where `moves` says so, and rests at 0.3 where not.
fn states(robot: &Robot, moves: impl Fn(usize) -> bool, still: bool) -> States {
    let mut rng = Seed::new(2).stream("states", 0);
    let mut states = States::new(robot.dof());
    for _ in 0..200 {
        let mut draw = |rest: f64, bound: f64| -> Vec<f64> {
            (0..robot.dof()).map(|i| if moves(i) { rng.random_range(-bound..bound) } else { rest }).collect()
        };
        let q = draw(0.3, 3.0);
        let (qd, qdd) = (draw(0.0, 2.0), draw(0.0, 9.0));
        let zero = vec![0.0; robot.dof()];
        states.push(&q, if still { &zero } else { &qd }, if still { &zero } else { &qdd });
    }
    states
}

#[test]
fn analytic_a_planar_arm_at_rest_shows_its_gravity_moments_only() {
    // Two moments in the plane for each link: X1 + a1 m2, Y1, X2, Y2.
    let arm = planar_2r();
    for method in [Method::Radkhah2007, Method::Qr] {
        let base = reduce_on(&arm, Columns::RIGID, method, &states(&arm, |_| true, true)).unwrap();
        assert_eq!(base.rank(), 4, "{}", method.name());
    }
}

#[test]
fn analytic_a_planar_arm_without_gravity_and_with_its_elbow_held() {
    // τ1 = (J1 + J2 + 2 a1 A) q̈1, τ2 = (J2 + a1 A) q̈1 + a1 B q̇1² with A, B the moments of link 2 along and across
    // link 1: three numbers.
    let arm = planar_2r().with_gravity(nalgebra::Vector3::zeros());
    let base = reduce_on(&arm, Columns::RIGID, Method::Qr, &states(&arm, |i| i == 0, false)).unwrap();
    assert_eq!(base.rank(), 3);
}

#[test]
fn identity_a_motion_degrades_categories_and_never_upgrades_them() {
    let arm = a460();
    let full = reduce(&arm, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(1)).unwrap();
    let rich = states(&arm, |_| true, false);
    let by_states = reduce_on(&arm, Columns::RIGID_ROTOR_FRICTION, Method::Qr, &rich).unwrap();
    assert_eq!((&by_states.kept, &by_states.categories), (&full.kept, &full.categories));
    assert!((&by_states.k - &full.k).amax() < 1e-8);

    let first_three = states(&arm, |i| i < 3, false);
    let [paper, qr] = [Method::Radkhah2007, Method::Qr]
        .map(|method| reduce_on(&arm, Columns::RIGID_ROTOR_FRICTION, method, &first_three).unwrap());
    assert_eq!((&paper.kept, &paper.categories), (&qr.kept, &qr.categories));
    assert!(qr.rank() < full.rank());
    for (now, before) in qr.categories.iter().zip(&full.categories) {
        let alone = *now == Category::Identifiable;
        assert!(!alone || *before == Category::Identifiable, "found alone only where it was");
        assert!(*before != Category::Unidentifiable || *now == Category::Unidentifiable);
    }
    let w = JointTorqueRegressor::new(&arm, Columns::RIGID_ROTOR_FRICTION).unwrap().stack(&first_three);
    let rebuilt = product(&qr.select_columns(&w), &qr.k);
    assert!((&w - rebuilt).norm() < 1e-12 * w.norm());
    // Formulas that still hold are printed as such, the others as numbers; both evaluate to K.
    for (row, formula) in qr.formulas(&arm).iter().enumerate() {
        for ((_, coefficient), (_, value)) in formula.terms.iter().zip(qr.terms(row)) {
            assert!((evaluated(coefficient, &arm) - value).abs() < 1e-6 * value.abs());
        }
    }
}

#[test]
fn errors_say_what_was_found() {
    let arm = planar_2r();
    let good = states(&arm, |_| true, false);
    let reduce = |method, states: &States| reduce_on(&arm, Columns::RIGID, method, states).unwrap_err();
    assert_eq!(
        reduce(Method::Structural, &good).to_string(),
        "method \"structural\" on a given trajectory, expected \"paper\" or \"qr\""
    );
    assert_eq!(
        reduce(Method::Qr, &States::with_len(3, 20)).to_string(),
        "states of 3 joints, expected 2 for robot \"planar-2r\""
    );
    assert_eq!(reduce(Method::Qr, &States::with_len(2, 4)), BaseError::TooFewSamples { found: 4, expected: 10 });
    let mut bad = good;
    bad.qdd[2 * 7] = f64::NAN;
    assert!(matches!(reduce(Method::Radkhah2007, &bad), BaseError::NotFinite { sample: 7, .. }));
}
