//! The optimum against that of a semidefinite program, which `tests/clarabel/generate.py` solved.

use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

use super::{Prior, ShapeBounds, constrained_fit, definite_inverse};
use crate::base::{Method, reduce};
use crate::estimation::Termination;
use crate::model::format::parse_robot;
use crate::model::{Columns, ParameterKind, StandardParameters, bundled};
use crate::seed::Seed;
use crate::spatial::PseudoInertia;

/// Relative distance from the optimum; primal and dual value of the program differ by up to 3e-8.
const OPTIMUM: f64 = 1e-6;
/// Standard deviations over the size of the parameters, run by run.
const LEVELS: [f64; 3] = [1e-3, 3e-2, 0.3];

/// The generator of numbers that `generate.py` has.
struct Generator(u64);

impl Generator {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn body(&mut self) -> PseudoInertia {
        let mass = self.uniform(1.0, 5.0);
        let centre = Vector3::from_fn(|_, _| self.uniform(-0.1, 0.1)).push(1.0);
        let mut p: Matrix4<f64> = centre * centre.transpose();
        for axis in 0..3 {
            p[(axis, axis)] += self.uniform(0.002, 0.02);
        }
        PseudoInertia(p * mass)
    }
}

#[test]
fn clarabel_the_objective_is_the_optimum_of_the_semidefinite_program() {
    let mut answers = 0;
    for line in include_str!("optima.csv").lines().skip(1) {
        let [name, run, primal, dual] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
        let known = bundled().iter().find(|known| known.name == name).expect("a bundled robot");
        let place = ["planar-2r", "crs-a460", "puma-560", "staubli-tx40"].iter().position(|known| *known == name);
        let robot = parse_robot(known.robot).expect("a bundled robot");
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let run: usize = run.parse().unwrap();
        let mut draw = Generator((1000 * place.unwrap() + run + 1) as u64);
        let mut guess = StandardParameters::zero(robot.dof());
        let mut truth = DVector::zeros(base.parameters.len());
        for (c, &id) in base.parameters.iter().enumerate() {
            match id.kind {
                ParameterKind::M => {
                    guess.links[id.index] = draw.body().inertia();
                    let factor = draw.uniform(0.7, 1.4);
                    for (k, value) in guess.links[id.index].to_array().into_iter().enumerate() {
                        truth[c + k] = factor * value;
                    }
                }
                ParameterKind::Term(_) => {
                    guess.set(id, draw.uniform(0.1, 2.0));
                    truth[c] = draw.uniform(0.7, 1.4) * guess.get(id);
                }
                ParameterKind::Mcx
                | ParameterKind::Mcy
                | ParameterKind::Mcz
                | ParameterKind::Ixx
                | ParameterKind::Ixy
                | ParameterKind::Ixz
                | ParameterKind::Iyy
                | ParameterKind::Iyz
                | ParameterKind::Izz => {}
            }
        }
        let exact = base.beta(&truth);
        let deviation = exact.map(|x| LEVELS[run % 3] * (x.abs() + 0.05));
        let shared = exact.map(|_| draw.uniform(-1.0, 1.0));
        let b = exact.len();
        let covariance = DMatrix::from_fn(b, b, |i, j| {
            deviation[i] * deviation[j] * (f64::from(u8::from(i == j)) + 0.3 * shared[i] * shared[j])
        });
        let mut beta = &exact + deviation.map(|d| d * draw.uniform(-2.5, 2.5));
        for (row, name) in base.names().iter().enumerate() {
            if name.starts_with("Fv1") || name.starts_with("Fc2") {
                beta[row] = -3.0 * deviation[row];
            }
        }
        let information = definite_inverse(&covariance).unwrap();
        let data = (&beta, information.clone(), &covariance);
        let fit = constrained_fit(&base, (&guess, &ShapeBounds::default()), data, Prior::None).unwrap();
        let Termination::Optimal { gap, .. } = fit.termination else { panic!("{name} {run}: {:?}", fit.termination) };
        let r = base.beta(&fit.phi) - &beta;
        let found = r.dot(&(information * &r));
        let (primal, dual): (f64, f64) = (primal.parse().unwrap(), dual.parse().unwrap());
        assert!((found / primal - 1.0).abs() < OPTIMUM && (found / dual - 1.0).abs() < OPTIMUM, "{line}: {found}");
        assert!(gap <= 1e-7, "{line}: {gap}");
        answers += 1;
    }
    assert_eq!(answers, 12);
}

#[test]
fn analytic_a_bound_of_the_shape_holds_mass_inside_it() {
    // Two links whose estimate wants the mass of the second a metre away; the shape ends at 0.3 m.
    let known = bundled().iter().find(|known| known.name == "planar-2r").expect("a bundled robot");
    let robot = parse_robot(known.robot).expect("a bundled robot");
    let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
    let shapes = ShapeBounds::of(&robot);
    let mut guess = StandardParameters::zero(2);
    for link in 0..2 {
        let (centre, radius) = shapes.ball(link).expect("a shape");
        let x = centre.push(1.0);
        let mut p: Matrix4<f64> = x * x.transpose();
        for axis in 0..3 {
            p[(axis, axis)] += 0.2 * radius * radius;
        }
        guess.links[link] = PseudoInertia(p).inertia();
    }
    let mut beta = base.beta(&base.parameters.iter().map(|&id| guess.get(id)).collect::<Vec<_>>().into());
    let at = base.names().iter().position(|name| name == "mcy2").expect("a base parameter");
    beta[at] = 1.0;
    let covariance = DMatrix::identity(beta.len(), beta.len()) * 1e-2;
    let information = definite_inverse(&covariance).unwrap();
    let fit = |shapes: &ShapeBounds| {
        let data = (&beta, information.clone(), &covariance);
        constrained_fit(&base, (&guess, shapes), data, Prior::None).unwrap()
    };
    let reach = |phi: &DVector<f64>| {
        let c = base.parameters.iter().position(|id| id.kind == ParameterKind::M && id.index == 1).unwrap();
        (phi[c + 2] / phi[c]).abs()
    };
    let (free, held) = (fit(&ShapeBounds::default()), fit(&shapes));
    let radius = shapes.ball(1).unwrap().1;
    assert!(reach(&free.phi) > radius && reach(&held.phi) < radius, "{} {}", reach(&free.phi), reach(&held.phi));
    assert!(held.termination.was_successful() && held.beyond_shape.is_empty());
    // A guess that is not inside takes the bound away, and says so.
    guess.links[1] = PseudoInertia(Matrix4::identity()).inertia();
    let data = (&beta, information.clone(), &covariance);
    let beyond = constrained_fit(&base, (&guess, &shapes), data, Prior::None).unwrap();
    assert_eq!(beyond.beyond_shape, [2]);
}
