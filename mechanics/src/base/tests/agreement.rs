//! The three methods agree, and `Y φ = Y_b β`.

use nalgebra::{DVector, dmatrix};
use rand::RngExt;

use super::chains::{a460, bundled_robots, parts, random_chains, relengthened};
use crate::base::{BaseReduction, Method, reduce, structural_base};
use crate::chains::{ChainRecipe, planar_2r};
use crate::linalg::product;
use crate::model::{Columns, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::spatial::Placement;

/// The random states carry 1e-15 of rounding, amplified where an arm is nearly special: over 4000 chains of 1 to 7
/// joints the largest difference was 1.2e-10 of K's largest entry.
const SAME_K: f64 = 1e-9;

fn three(robot: &Robot, columns: Columns) -> [BaseReduction; 3] {
    Method::ALL.map(|method| structural_base(robot, columns, method, Seed::new(3)).unwrap())
}

fn assert_same(a: &BaseReduction, b: &BaseReduction, robot: &Robot) {
    let what = format!("{}: {} against {}", robot.name(), a.method.name(), b.method.name());
    assert_eq!(a.names(), b.names(), "{what}");
    assert_eq!(a.categories, b.categories, "{what}");
    let (error, size) = ((&a.k - &b.k).amax(), b.k.amax().max(1.0));
    assert!(error < SAME_K * size, "{what}: K differs by {error:.1e} of {size:.1e}");
}

#[test]
fn identity_three_methods_agree_on_random_chains() {
    for (robot, columns) in random_chains(210) {
        let [paper, qr, structural] = three(&robot, columns);
        assert_same(&paper, &structural, &robot);
        assert_same(&qr, &structural, &robot);
    }
}

#[test]
fn identity_recursion_and_qr_agree_on_long_chains() {
    for (run, dof) in [(0, 16), (1, 24)] {
        let (robot, _) = ChainRecipe::new(dof).draw(&mut Seed::new(6).stream("long chains", run));
        let [structural, qr] = [Method::Structural, Method::Qr]
            .map(|method| structural_base(&robot, Columns::RIGID_ROTOR, method, Seed::new(3)).unwrap());
        assert_same(&qr, &structural, &robot);
    }
}

#[test]
fn identity_three_methods_agree_on_bundled_robots() {
    for robot in bundled_robots() {
        for columns in Columns::ALL {
            let [paper, qr, structural] = three(&robot, columns);
            assert_same(&paper, &structural, &robot);
            assert_same(&qr, &structural, &robot);
        }
    }
}

#[test]
fn analytic_a_differential_gear_regroups_friction_and_rotors() {
    // Motors at q1 + q2 and q1 − q2, plain signs. Viscous friction fills three entries of a symmetric 2 × 2 matrix with
    // four parameters; the four sign forms q̇1, q̇2, q̇1 ± q̇2 are independent; of the rotors, H22 − H12 = 2 Ia2 shows
    // alone and Ia1 goes over to the links: 6 rigid + 1 rotor + 3 viscous + 4 Coulomb + 2 offsets.
    let mut spec = parts(&planar_2r());
    spec.coupling = Some(dmatrix![1.0, 1.0; 1.0, -1.0]);
    for joint in &mut spec.joints {
        joint.drive.coulomb_velocity = 0.0;
    }
    let robot = Robot::new(spec).unwrap();
    let [paper, qr, structural] = three(&robot, Columns::RIGID_ROTOR_FRICTION);
    assert_eq!((structural.parameters.len(), structural.rank()), (32, 16));
    assert_same(&paper, &structural, &robot);
    assert_same(&qr, &structural, &robot);
    let texts = structural.expressions(&robot);
    // Fvm1 (1 1; 1 1) + Fvm2 (1 −1; −1 1) + diag(Fv1, Fv2): the off-diagonal entry is Fvm1 − Fvm2.
    for expected in ["Ia2", "Fv1 + 2·Fvm2", "Fv2 + 2·Fvm2", "Fvm1 − Fvm2", "Fcm1", "Fcm2"] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is not among {texts:#?}");
    }
}

#[test]
fn identity_base_regressor_gives_the_same_torque() {
    let mut rng = Seed::new(8).stream("torques", 0);
    let bundled = bundled_robots().into_iter().map(|robot| (robot, Columns::RIGID_ROTOR_FRICTION));
    for (robot, columns) in bundled.chain(random_chains(42)) {
        let base = structural_base(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
        let regressor = JointTorqueRegressor::new(&robot, columns).unwrap();
        // Parameters of any value, physical or not: the identity is linear.
        let phi = DVector::from_fn(regressor.cols(), |_, _| rng.random_range(-1.0..1.0));
        let beta = base.beta(&phi);
        let mut y = vec![0.0; regressor.rows() * regressor.cols()];
        for _ in 0..20 {
            let (q, qd, qdd) = crate::chains::random_state(&mut rng, robot.dof());
            regressor.evaluate(&q, &qd, &qdd, &mut y);
            for row in y.chunks_exact(regressor.cols()) {
                let tau: f64 = row.iter().zip(&phi).map(|(y, x)| y * x).sum();
                let by_base: f64 = base.kept.iter().zip(&beta).map(|(&j, b)| row[j] * b).sum();
                let size: f64 = base.kept.iter().zip(&beta).map(|(&j, b)| (row[j] * b).abs()).sum();
                // Rounding of a sum of some fifty terms of this size, and of K's own.
                assert!((tau - by_base).abs() <= 1e-12 * size.max(1.0), "{}: {tau} {by_base}", robot.name());
            }
        }
    }
}

#[test]
fn identity_neither_the_seed_nor_the_unit_of_length_matters() {
    let arm = a460();
    let [_, first, structural] = three(&arm, Columns::RIGID_ROTOR_FRICTION);
    let second = structural_base(&arm, Columns::RIGID_ROTOR_FRICTION, Method::Qr, Seed::new(4)).unwrap();
    assert_same(&first, &second, &arm);
    // An arm of half a millimetre, and one of a kilometre.
    for factor in [5e-4, 1e3] {
        let other = relengthened(&arm, || factor);
        for reduction in three(&other, Columns::RIGID_ROTOR_FRICTION) {
            assert_eq!(reduction.names(), structural.names());
            assert_eq!(reduction.categories, structural.categories);
        }
    }
}

#[test]
fn identity_k_is_an_echelon_form_whose_rows_span_those_of_the_regressor() {
    for (robot, columns) in random_chains(21) {
        let base = structural_base(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
        for (row, &kept) in base.kept.iter().enumerate() {
            assert!(base.k.column(kept).iter().enumerate().all(|(i, &x)| x == if i == row { 1.0 } else { 0.0 }));
            assert!(base.k.row(row).iter().take(kept).all(|&x| x == 0.0), "nothing left of a kept column");
            assert_eq!(base.terms(row)[0], (base.parameters[kept], 1.0));
        }
        // W = W_b K on states of another kind than those the methods draw.
        let mut rng = Seed::new(1).stream("span", 0);
        let mut states = crate::dynamics::States::new(robot.dof());
        for _ in 0..30 {
            let (q, qd, qdd) = crate::chains::random_state(&mut rng, robot.dof());
            states.push(&q, &qd, &qdd);
        }
        let w = JointTorqueRegressor::new(&robot, columns).unwrap().stack(&states);
        let rebuilt = product(&base.select_columns(&w), &base.k);
        assert!((&w - rebuilt).norm() <= 1e-10 * base.k.amax().max(1.0) * w.norm(), "{}", robot.name());
    }
}

#[test]
fn identity_what_torque_hardly_shows_is_left_out_by_every_method_alike() {
    // The shoulder's axis turned out of its plane: 1e-8 rad no sensor sees, 1e-2 rad it does.
    let tilted = |by: f64| {
        let mut spec = parts(&a460());
        for joint in &mut spec.joints {
            joint.dh = None;
        }
        let (s, c) = libm::sincos(by);
        let turn = Placement::rotation_x(s, c).compose(&Placement::rotation_y(s, c));
        spec.joints[1].before = turn.compose(&spec.joints[1].before);
        Robot::new(spec).unwrap()
    };
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let exact = reduce(&a460(), columns, Method::Structural, Seed::new(1)).unwrap();
    assert_eq!((exact.rank(), &exact.nearly_dependent), (58, &None));
    for method in Method::ALL {
        let reduced = reduce(&tilted(1e-8), columns, method, Seed::new(2)).unwrap();
        assert_eq!((reduced.names(), &reduced.categories), (exact.names(), &exact.categories), "{method:?}");
        let left_out = reduced.nearly_dependent.expect("columns were left out");
        assert!(left_out.structural_rank > 58 && !left_out.parameters.is_empty(), "{left_out:?}");
        assert!(left_out.to_string().contains("1e-6"), "{left_out}");
        let seen = reduce(&tilted(1e-2), columns, method, Seed::new(2)).unwrap();
        assert!(seen.rank() > 58, "{method:?}");
    }
    // What is left out changes the torque by less than the tolerance.
    let robot = tilted(1e-8);
    let base = reduce(&robot, columns, Method::Structural, Seed::new(1)).unwrap();
    let mut rng = Seed::new(2).stream("nearly dependent", 0);
    let mut states = crate::dynamics::States::new(robot.dof());
    for _ in 0..30 {
        let (q, qd, qdd) = crate::chains::random_state(&mut rng, robot.dof());
        states.push(&q, &qd, &qdd);
    }
    let w = JointTorqueRegressor::new(&robot, columns).unwrap().stack(&states);
    let rebuilt = product(&base.select_columns(&w), &base.k);
    assert!((&w - rebuilt).norm() <= 1e-6 * w.norm());
}
