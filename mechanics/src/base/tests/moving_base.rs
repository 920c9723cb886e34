//! A moving base is a robot with more joints, whose first efforts nobody measures.

use nalgebra::DMatrix;

use super::chains::{a460, parts, random_chains};
use crate::base::geometry::Geometry;
use crate::base::{BaseMotion, Category, Method, reduce, reduce_with_base};
use crate::linalg::{LeftToRight, RankTolerance};
use crate::model::{Columns, Drive, Joint, JointKind, Limits, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::spatial::Placement;

/// The robot on joints that let its base move, and how many they are.
fn on_joints(robot: &Robot, motion: BaseMotion) -> (Robot, usize) {
    let to_x = Placement::rotation_y(1.0, 0.0);
    let to_y = Placement::rotation_x(-1.0, 0.0);
    let to_z = Placement::identity();
    let (slide, turn) = (JointKind::Prismatic, JointKind::Revolute);
    let added: Vec<(JointKind, Placement)> = match motion {
        BaseMotion::Fixed => vec![],
        BaseMotion::Planar => vec![(slide, to_x), (slide, to_y), (turn, to_z)],
        BaseMotion::Free => {
            vec![(slide, to_x), (slide, to_y), (slide, to_z), (turn, to_x), (turn, to_y), (turn, to_z)]
        }
    };
    let mut spec = parts(robot);
    let count = added.len();
    let virtual_joints = added.into_iter().enumerate().map(|(i, (kind, before))| Joint {
        name: format!("base {i}"),
        kind,
        before,
        after: before.inverse(),
        dh: None,
        limits: Limits::NONE,
        drive: Drive::ideal(),
    });
    spec.joints = virtual_joints.chain(spec.joints).collect();
    spec.coupling = spec.coupling.map(|c| {
        let n = c.nrows();
        let mut whole = DMatrix::identity(n + count, n + count);
        whole.view_mut((count, count), (n, n)).copy_from(&c);
        whole
    });
    (Robot::new(spec).unwrap(), count)
}

/// The columns of the robot's own parameters in the rows of its own joints, stacked over random states, in sound units.
fn own_regressor(robot: &Robot, columns: Columns, motion: BaseMotion) -> (DMatrix<f64>, Vec<f64>) {
    let (whole, added) = on_joints(robot, motion);
    let geometry = Geometry::of(&whole);
    let regressor = JointTorqueRegressor::new(&whole, columns).unwrap();
    let mut rng = Seed::new(6).stream("states", 0);
    let states = geometry.random_states(2 * regressor.cols(), &mut rng);
    let w = regressor.stack(&states);
    let own: Vec<usize> = (0..regressor.cols()).filter(|&j| regressor.parameters()[j].index >= added).collect();
    let rows: Vec<usize> = (0..w.nrows()).filter(|row| row % whole.dof() >= added).collect();
    let units: Vec<f64> = own.iter().map(|&j| geometry.unit(regressor.parameters()[j])).collect();
    let mut w = w.select_columns(&own).select_rows(&rows);
    for (mut column, unit) in w.column_iter_mut().zip(&units) {
        column *= *unit;
    }
    (w, units)
}

#[test]
fn identity_the_recursion_and_a_robot_on_more_joints_agree() {
    let chains = random_chains(30).into_iter().filter(|(robot, _)| robot.dof() < 6);
    for (robot, columns) in chains.chain([(a460(), Columns::RIGID_ROTOR_FRICTION)]) {
        for motion in BaseMotion::ALL {
            let base = reduce_with_base(&robot, columns, motion, Method::Structural, Seed::new(1)).unwrap();
            let (w, units) = own_regressor(&robot, columns, motion);
            let qr = LeftToRight::new(&w, RankTolerance::default());
            assert_eq!(base.kept, qr.kept, "{} {} {columns:?}", robot.name(), motion.name());
            let size = base.k.amax().max(1.0);
            for (row, &b) in base.kept.iter().enumerate() {
                for j in 0..base.parameters.len() {
                    let other = qr.coefficients[(row, j)] * units[b] / units[j];
                    // Unit bases and random states as in the fixed case, with more joints in the way.
                    assert!((base.k[(row, j)] - other).abs() < 1e-8 * size, "{} {}", robot.name(), motion.name());
                }
            }
        }
    }
}

#[test]
fn published_claim_a_mobile_base_reveals_all_of_link_one_holds_in_part() {
    // `radkhah2007` section IV.C: "If we install the robot on a mobile base, we might be able to identify also the 9
    // unidentifiable parameters of axis 1". Six directions reveal six of the nine, a platform two.
    let arm = a460();
    let on = |motion, method| reduce_with_base(&arm, Columns::RIGID, motion, method, Seed::new(2)).unwrap();
    let free = on(BaseMotion::Free, Method::Structural);
    assert_eq!(free.rank(), 42);
    let invisible: Vec<String> = (0..60)
        .filter(|&j| free.categories[j] == Category::Unidentifiable)
        .map(|j| free.parameters[j].to_string())
        .collect();
    assert_eq!(invisible, ["m1", "mcy1"]);
    let texts = free.expressions(&arm);
    assert!(texts.iter().any(|text| text.starts_with("Ixx1 − Izz1 + ")), "{texts:#?}");
    let by_states = reduce_with_base(&arm, Columns::RIGID, BaseMotion::Free, Method::Qr, Seed::new(3)).unwrap();
    assert_eq!((&by_states.kept, by_states.base_motion), (&free.kept, BaseMotion::Free));
    assert_eq!(by_states.expressions(&arm), texts);
    for method in Method::ALL {
        assert_eq!(on(BaseMotion::Planar, method).rank(), 38, "{}", method.name());
        assert_eq!(on(BaseMotion::Fixed, method).rank(), 36, "{}", method.name());
    }
}

#[test]
fn identity_three_methods_agree_on_a_moving_base() {
    for (robot, columns) in random_chains(42) {
        for motion in [BaseMotion::Planar, BaseMotion::Free] {
            let [paper, qr, structural] =
                Method::ALL.map(|method| reduce_with_base(&robot, columns, motion, method, Seed::new(2)).unwrap());
            for other in [paper, qr] {
                assert_eq!(other.kept, structural.kept, "{} {}", robot.name(), motion.name());
                assert_eq!(other.categories, structural.categories);
                let size = structural.k.amax().max(1.0);
                assert!((&other.k - &structural.k).amax() < 1e-9 * size, "{} {}", robot.name(), motion.name());
            }
        }
    }
}

#[test]
fn identity_a_base_at_rest_is_a_fixed_base() {
    let arm = a460();
    let fixed = reduce(&arm, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(1)).unwrap();
    for method in Method::ALL {
        let other =
            reduce_with_base(&arm, Columns::RIGID_ROTOR_FRICTION, BaseMotion::Fixed, method, Seed::new(1)).unwrap();
        assert_eq!((&other.kept, &other.categories), (&fixed.kept, &fixed.categories));
    }
}
