//! Laws of mechanics that the equations of motion must obey, and textbook equations of small arms.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::{Dynamics, States};
use crate::chains::{self, ChainRecipe};
use crate::model::term::{COULOMB, MOTOR_COULOMB, MOTOR_VISCOUS, OFFSET, ROTOR, VISCOUS};
use crate::model::{DhConvention, DhRow, JointKind, Robot, RobotSpec, StandardParameters};
use crate::seed::{Seed, Stream};
use crate::spatial::{Inertia, Placement};

/// Random chains of one to eight joints, of every kind.
fn chains_of_every_kind(count: u64) -> impl Iterator<Item = (Robot, StandardParameters, Stream)> {
    (0..count).map(|run| {
        let mut rng = Seed::new(13).stream("laws", run);
        let dof = 1 + usize::try_from(run % 8).unwrap();
        let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
        let (robot, parameters) = recipe.draw(&mut rng);
        (robot, parameters, rng)
    })
}

/// The parameters without friction and offset: what remains conserves energy.
fn frictionless(parameters: &StandardParameters) -> StandardParameters {
    let mut bare = parameters.clone();
    for drive in &mut bare.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    bare
}

fn inverse(dynamics: &mut Dynamics, q: &[f64], qd: &[f64], qdd: &[f64]) -> DVector<f64> {
    let mut tau = DVector::zeros(q.len());
    dynamics.inverse(q, qd, qdd, tau.as_mut_slice());
    tau
}

/// Central difference with Richardson's correction: error `h⁴`.
fn derivative<T>(h: f64, mut f: impl FnMut(f64) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let wide = (f(2.0 * h) - f(-2.0 * h)) * (1.0 / (4.0 * h));
    let narrow = (f(h) - f(-h)) * (1.0 / (2.0 * h));
    narrow * (4.0 / 3.0) - wide * (1.0 / 3.0)
}

fn moved(q: &[f64], by: impl Fn(usize) -> f64) -> Vec<f64> {
    q.iter().enumerate().map(|(j, q)| q + by(j)).collect()
}

#[test]
fn identity_mass_matrix_columns_are_differences_of_inverse_dynamics() {
    for (robot, parameters, mut rng) in chains_of_every_kind(40) {
        let n = robot.dof();
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let (q, qd, _) = chains::random_state(&mut rng, n);
        let mass = dynamics.mass_matrix(&q);
        let still = inverse(&mut dynamics, &q, &qd, &vec![0.0; n]);
        for j in 0..n {
            let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
            let column = inverse(&mut dynamics, &q, &qd, &unit) - &still;
            // Rounding of the torques that are subtracted.
            assert!((column - mass.column(j)).amax() < 1e-12 * (mass.amax() + still.amax()));
        }
        assert_eq!(mass, mass.transpose());
        assert!(mass.cholesky().is_some(), "a body that exists resists acceleration");
    }
}

#[test]
fn identity_lagrange_equations_and_passivity() {
    for (robot, parameters, mut rng) in chains_of_every_kind(24) {
        let n = robot.dof();
        let mut dynamics = Dynamics::new(&robot, &frictionless(&parameters));
        let (q, qd, _) = chains::random_state(&mut rng, n);
        let qd = DVector::from_vec(qd);
        // ∂M/∂q_k, and Christoffel's C of them.
        let slopes: Vec<DMatrix<f64>> = (0..n)
            .map(|k| derivative(1e-3, |h| dynamics.mass_matrix(&moved(&q, |j| if j == k { h } else { 0.0 }))))
            .collect();
        let c = DMatrix::from_fn(n, n, |i, j| {
            (0..n).map(|k| 0.5 * (slopes[k][(i, j)] + slopes[j][(i, k)] - slopes[i][(j, k)]) * qd[k]).sum()
        });
        let still = vec![0.0; n];
        let bias = inverse(&mut dynamics, &q, qd.as_slice(), &still) - inverse(&mut dynamics, &q, &still, &still);
        let size = bias.amax().max(1.0);
        // Differences: h⁴ = 1e-12 times a fifth derivative, and rounding 1e-16 / h.
        assert!((&c * &qd - &bias).amax() < 1e-9 * size, "{bias} {}", &c * &qd);
        let rate =
            slopes.iter().zip(&qd).fold(DMatrix::zeros(n, n), |sum: DMatrix<f64>, (slope, qd)| sum + slope * *qd);
        let passive = rate - c * 2.0;
        assert!((&passive + passive.transpose()).amax() < 1e-12 * size);
        // Gravity's torque is the slope of the potential.
        let gravity = inverse(&mut dynamics, &q, &still, &still);
        for k in 0..n {
            let slope =
                derivative(1e-3, |h| dynamics.energy(&moved(&q, |j| if j == k { h } else { 0.0 }), &still).potential);
            assert!((slope - gravity[k]).abs() < 1e-9 * gravity.amax().max(1.0));
        }
        let kinetic = dynamics.energy(&q, qd.as_slice()).kinetic;
        let by_matrix = 0.5 * qd.dot(&(dynamics.mass_matrix(&q) * &qd));
        assert!((kinetic - by_matrix).abs() < 1e-13 * kinetic.max(1.0));
    }
}

#[test]
fn identity_power_is_the_rate_of_energy() {
    for (robot, parameters, mut rng) in chains_of_every_kind(24) {
        let n = robot.dof();
        let mut dynamics = Dynamics::new(&robot, &frictionless(&parameters));
        let (q, qd, qdd) = chains::random_state(&mut rng, n);
        let power = inverse(&mut dynamics, &q, &qd, &qdd).dot(&DVector::from_column_slice(&qd));
        let rate = derivative(1e-3, |t| {
            let q = moved(&q, |j| qd[j] * t + 0.5 * qdd[j] * t * t);
            let qd = moved(&qd, |j| qdd[j] * t);
            dynamics.energy(&q, &qd).total()
        });
        assert!((power - rate).abs() < 1e-8 * power.abs().max(10.0), "{power} {rate}");
    }
}

#[test]
fn identity_coasting_arm_loses_what_friction_takes() {
    // With no effort d(T + V)/dt = −q̇ᵀ τ_friction, friction written out here joint by joint.
    for (robot, parameters, mut rng) in chains_of_every_kind(24) {
        if robot.coupling().is_some() {
            continue;
        }
        let n = robot.dof();
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let (q, qd, _) = chains::random_state(&mut rng, n);
        let mut qdd = vec![0.0; n];
        dynamics.forward(&q, &qd, &vec![0.0; n], &mut qdd);
        let loss: f64 = (0..n)
            .map(|j| {
                let drive = &parameters.drives[j];
                let v_s = robot.joints()[j].drive.coulomb_velocity;
                qd[j] * (drive[VISCOUS] * qd[j] + drive[COULOMB] * (qd[j] / v_s).tanh() + drive[OFFSET])
            })
            .sum();
        // Short steps: accelerations of a coasting arm reach hundreds of rad/s².
        let rate = derivative(1e-4, |t| {
            let q = moved(&q, |j| qd[j] * t + 0.5 * qdd[j] * t * t);
            let qd = moved(&qd, |j| qdd[j] * t);
            dynamics.energy(&q, &qd).total()
        });
        assert!((rate + loss).abs() < 1e-7 * loss.abs().max(10.0), "{rate} {loss}");
    }
}

#[test]
fn analytic_drives_and_coupled_motors() {
    // Links without inertia: what remains is τ = Cᵀ(Ia C q̈ + Fvm C q̇ + Fcm tanh) + Fv q̇ + Fc tanh + Fo.
    for (robot, parameters, mut rng) in chains_of_every_kind(16) {
        let n = robot.dof();
        let mut drives = StandardParameters::zero(n);
        drives.drives.clone_from(&parameters.drives);
        let (q, qd, qdd) = chains::random_state(&mut rng, n);
        let tau = inverse(&mut Dynamics::new(&robot, &drives), &q, &qd, &qdd);
        let c = robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
        let (motor_qd, motor_qdd) = (&c * DVector::from_column_slice(&qd), &c * DVector::from_column_slice(&qdd));
        let sign = |v: f64, j: usize| (v / robot.joints()[j].drive.coulomb_velocity).tanh();
        let motor = DVector::from_fn(n, |j, _| {
            let d = &parameters.drives[j];
            d[ROTOR] * motor_qdd[j] + d[MOTOR_VISCOUS] * motor_qd[j] + d[MOTOR_COULOMB] * sign(motor_qd[j], j)
        });
        let joint = DVector::from_fn(n, |j, _| {
            let d = &parameters.drives[j];
            d[VISCOUS] * qd[j] + d[COULOMB] * sign(qd[j], j) + d[OFFSET]
        });
        assert!((tau - (c.transpose() * motor + joint)).amax() < 1e-12);
    }
}

#[test]
fn analytic_planar_arm_is_the_textbook_one() {
    // M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, Wiley 2006, ch. 7, planar elbow manipulator.
    let robot = chains::planar_2r();
    let (l1, l2, g) = (0.4, 0.3, 9.81);
    let (m1, m2, lc1, lc2, i1, i2) = (3.0, 2.0, 0.17, 0.11, 0.05, 0.03);
    let mut parameters = StandardParameters::zero(2);
    // The link frames stand at the far ends.
    let about_z = |i: f64| Matrix3::from_diagonal(&Vector3::new(0.5 * i, 0.6 * i, i));
    parameters.links[0] = Inertia::from_com(m1, Vector3::new(lc1 - l1, 0.0, 0.0), about_z(i1));
    parameters.links[1] = Inertia::from_com(m2, Vector3::new(lc2 - l2, 0.0, 0.0), about_z(i2));
    let mut dynamics = Dynamics::new(&robot, &parameters);
    let mut rng = Seed::new(14).stream("states", 0);
    let mut states = States::new(2);
    for _ in 0..50 {
        let (q, qd, qdd) = chains::random_state(&mut rng, 2);
        states.push(&q, &qd, &qdd);
    }
    for k in 0..states.len() {
        let (q, v, a) = (states.q(k), states.qd(k), states.qdd(k));
        let (s2, c2) = q[1].sin_cos();
        let d11 = m1 * lc1 * lc1 + m2 * (l1 * l1 + lc2 * lc2 + 2.0 * l1 * lc2 * c2) + i1 + i2;
        let d12 = m2 * (lc2 * lc2 + l1 * lc2 * c2) + i2;
        let d22 = m2 * lc2 * lc2 + i2;
        let h = -m2 * l1 * lc2 * s2;
        let g2 = m2 * lc2 * g * (q[0] + q[1]).cos();
        let g1 = (m1 * lc1 + m2 * l1) * g * q[0].cos() + g2;
        let expected = [
            d11 * a[0] + d12 * a[1] + 2.0 * h * v[0] * v[1] + h * v[1] * v[1] + g1,
            d12 * a[0] + d22 * a[1] - h * v[0] * v[0] + g2,
        ];
        let tau = inverse(&mut dynamics, q, v, a);
        for (found, expected) in tau.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13 * 50.0, "{found} {expected}");
        }
        let mass = dynamics.mass_matrix(q);
        assert!((mass - DMatrix::from_row_slice(2, 2, &[d11, d12, d12, d22])).amax() < 1e-14);
    }
}

#[test]
fn analytic_polar_arm_with_a_prismatic_joint() {
    // A point mass at distance r: τ = m r² θ̈ + 2 m r ṙ θ̇ + m g r cos θ, F = m r̈ − m r θ̇² + m g sin θ.
    let planar = chains::planar_2r();
    let joint = |index: usize, kind: JointKind, row: DhRow| {
        let (before, after) = row.placements(DhConvention::Standard);
        crate::model::Joint { kind, before, after, dh: None, ..planar.joints()[index].clone() }
    };
    let turn = DhRow { offset_deg: 90.0, d: 0.0, a: 0.0, alpha_deg: 90.0 };
    let slide = DhRow { offset_deg: 0.0, d: 0.2, a: 0.0, alpha_deg: 0.0 };
    let robot = Robot::new(RobotSpec {
        name: "polar".to_owned(),
        gravity: Vector3::new(0.0, -9.81, 0.0),
        base: Placement::identity(),
        joints: vec![joint(0, JointKind::Revolute, turn), joint(1, JointKind::Prismatic, slide)],
        coupling: None,
        ..RobotSpec::default()
    })
    .unwrap();
    let m = 1.7;
    let mut parameters = StandardParameters::zero(2);
    parameters.links[1] = Inertia::from_com(m, Vector3::zeros(), Matrix3::zeros());
    let mut dynamics = Dynamics::new(&robot, &parameters);
    let mut rng = Seed::new(15).stream("states", 0);
    for _ in 0..50 {
        let (q, v, a) = chains::random_state(&mut rng, 2);
        let r = q[1] + 0.2;
        let expected = [
            m * r * r * a[0] + 2.0 * m * r * v[1] * v[0] + m * 9.81 * r * q[0].cos(),
            m * a[1] - m * r * v[0] * v[0] + m * 9.81 * q[0].sin(),
        ];
        let tau = inverse(&mut dynamics, &q, &v, &a);
        for (found, expected) in tau.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13 * 200.0, "{found} {expected}");
        }
    }
}
