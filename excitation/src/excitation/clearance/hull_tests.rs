//! Distances between hulls, against a quadratic program and against boxes.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, ZeroConeT};
use nalgebra::{Rotation3, Vector3};
use rand::{Rng, RngExt};

use super::body::Placed;
use crate::model::{Cuboid, Hull, Solid};
use crate::seed::Seed;
use crate::spatial::Placement;

fn hull(points: &[Vector3<f64>], pose: &Placement) -> Placed {
    Placed::new(&Solid::Hull(Hull::enclosing(points).unwrap()), pose)
}

fn turned(rng: &mut impl Rng) -> Placement {
    let angles: [f64; 3] = std::array::from_fn(|_| rng.random_range(-3.0..3.0));
    let place = Vector3::from_fn(|_, _| rng.random_range(-0.4..0.4));
    Placement::new(*Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).matrix(), place)
}

/// The distance of two hulls as a quadratic program in the weights of their corners, solved by Clarabel.
///
/// ```text
/// min |Σ λ_i p_i − Σ μ_j q_j|²        λ, μ ≥ 0, Σ λ = Σ μ = 1
/// ```
fn by_quadratic_program(p: &[Vector3<f64>], q: &[Vector3<f64>]) -> f64 {
    let n = p.len() + q.len();
    let all: Vec<Vector3<f64>> = p.iter().copied().chain(q.iter().map(|q| -q)).collect();
    let mut upper = CscMatrix::zeros((n, n));
    (upper.colptr, upper.rowval, upper.nzval) = (vec![0], Vec::new(), Vec::new());
    let mut a = CscMatrix::zeros((2 + n, n));
    (a.colptr, a.rowval, a.nzval) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n {
        for i in 0..=j {
            upper.rowval.push(i);
            upper.nzval.push(2.0 * all[i].dot(&all[j]));
        }
        upper.colptr.push(upper.rowval.len());
        a.rowval.extend([usize::from(j >= p.len()), 2 + j]);
        a.nzval.extend([1.0, -1.0]);
        a.colptr.push(a.rowval.len());
    }
    let mut b = vec![0.0; 2 + n];
    b[..2].fill(1.0);
    let cones = [ZeroConeT(2), NonnegativeConeT(n)];
    let settings = DefaultSettings { verbose: false, tol_gap_abs: 1e-12, tol_gap_rel: 1e-12, ..Default::default() };
    let mut solver = DefaultSolver::new(&upper, &vec![0.0; n], &a, &b, &cones, settings).unwrap();
    solver.solve();
    let apart: Vector3<f64> = all.iter().zip(&solver.solution.x).map(|(p, weight)| p * *weight).sum();
    apart.norm()
}

#[test]
fn clarabel_distances_of_hulls_are_those_of_a_quadratic_program() {
    let mut rng = Seed::new(12).stream("hulls", 0);
    let mut apart = 0;
    for _ in 0..60 {
        let mut cloud = |count: usize| -> Vec<Vector3<f64>> {
            (0..count).map(|_| Vector3::from_fn(|_, _| rng.random_range(-0.1..0.1))).collect()
        };
        let (p, q) = (cloud(12), cloud(9));
        let (here, there) = (turned(&mut rng), turned(&mut rng));
        let margins: f64 = [&p, &q].iter().map(|points| Hull::enclosing(points).unwrap().margin).sum();
        let (first, second) = (hull(&p, &here), hull(&q, &there));
        let found = first.separation(&second);
        let in_base = |points: &[Vector3<f64>], pose: &Placement| -> Vec<Vector3<f64>> {
            points.iter().map(|p| pose.point(p)).collect()
        };
        let (p, q) = (in_base(&p, &here), in_base(&q, &there));
        let exact = by_quadratic_program(&p, &q);
        if exact < 1e-5 {
            // They overlap, and along every direction by no less than the depth.
            assert!(found.distance < 1e-7, "{found:?} {exact}");
            continue;
        }
        apart += 1;
        // All corners may be there, or all but those within the margin.
        assert!(found.distance <= exact + 1e-7, "{found:?} {exact}");
        assert!(found.distance >= exact - margins - 1e-7, "{found:?} {exact}");
        assert!(first.at_least(&second, 0.0) <= found.distance + 1e-9);
    }
    assert!(apart > 40, "{apart}");
}

/// Boxes as hulls of their corners: `parry3d` knows boxes by a law of their own, planes by another.
#[test]
fn parry_boxes_as_hulls_are_as_far_apart_and_as_deep_as_boxes() {
    let mut rng = Seed::new(13).stream("hulls", 0);
    let half = [Vector3::new(0.1, 0.05, 0.2), Vector3::new(0.15, 0.1, 0.03)];
    let (mut inside, mut worst) = (0, 0.0_f64);
    for _ in 0..300 {
        let poses = [turned(&mut rng), turned(&mut rng)];
        let corners = |half: &Vector3<f64>| -> Vec<Vector3<f64>> {
            let sign = |k: usize| if k & 1 == 0 { -1.0 } else { 1.0 };
            (0..8).map(|k| half.component_mul(&Vector3::new(sign(k), sign(k >> 1), sign(k >> 2)))).collect()
        };
        let hulls: Vec<Placed> = (0..2).map(|i| hull(&corners(&half[i]), &poses[i])).collect();
        let boxes: Vec<Placed> = (0..2)
            .map(|i| Placed::new(&Solid::Cuboid(Cuboid { placement: poses[i], half: half[i] }), &Placement::identity()))
            .collect();
        let (a, b) = (hulls[0].separation(&hulls[1]), boxes[0].separation(&boxes[1]));
        assert!(a.distance <= b.distance + 1e-9, "{a:?} {b:?}");
        worst = worst.max(b.distance - a.distance);
        inside += usize::from(a.distance < 0.0);
        let mixed = hulls[0].separation(&boxes[1]);
        assert!((mixed.distance - a.distance).abs() < 1e-8, "{mixed:?} {a:?}");
        let plane = (hulls[0].above(&Vector3::z(), -0.5).distance, boxes[0].above(&Vector3::z(), -0.5).distance);
        assert!((plane.0 - plane.1).abs() < 1e-12);
    }
    assert!(inside > 30 && worst < 1e-8, "{inside} overlap, {worst}");
}
