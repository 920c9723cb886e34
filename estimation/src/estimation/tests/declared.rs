//! What is declared uncertain, against estimates from torque that has the error.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::setting::{a460_samples, white};
use crate::base::{Method, reduce};
use crate::chains::ChainRecipe;
use crate::dynamics::{Dynamics, States};
use crate::estimation::{Estimate, EstimationProblem, EstimatorKind, Observation};
use crate::model::term::{Term, VISCOUS};
use crate::model::{Columns, DeclaredUncertainty, ParameterKind, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::{NoiseModel, Samples};

const COUNT: usize = 200;

struct Case {
    robot: Robot,
    observe: Box<dyn Fn(&Samples) -> Observation>,
    samples: Samples,
}

/// A noisy periodic recording of the A460.
fn case() -> Case {
    let (robot, _, regressor, base, mut samples) = a460_samples(COUNT);
    let covariance = DMatrix::identity(6, 6) * 0.04;
    let noise = white(&covariance, COUNT, &mut Seed::new(71).stream("noise", 0));
    for (tau, noise) in samples.tau.iter_mut().zip(noise.iter()) {
        *tau += noise;
    }
    samples.noise = Some(NoiseModel::white(covariance, true, 1e9));
    samples.period_s = Some(10.0);
    let of = robot.clone();
    let observe = Box::new(move |samples: &Samples| Observation::new(&of, &regressor, &base, samples).unwrap());
    Case { robot, observe, samples }
}

fn estimate(robot: &Robot, case: &Case, samples: &Samples) -> Estimate {
    let observation = (case.observe)(samples);
    let problem =
        EstimationProblem { robot: Some(robot), samples: Some(samples), ..EstimationProblem::new(&observation) };
    EstimatorKind::Wls.estimator().estimate(&problem).unwrap()
}

fn declaring(robot: &Robot, key: &str, std: f64) -> Robot {
    robot.clone().with_uncertainty(DeclaredUncertainty::new(BTreeMap::from([(key.to_owned(), std)])).unwrap())
}

fn declared(estimate: &Estimate) -> DVector<f64> {
    DVector::from_iterator(estimate.base.len(), estimate.base.iter().map(|p| p.declared_std))
}

/// The estimates from torque with the error of one standard deviation of each motor in turn, less that without; squares summed.
fn moved(case: &Case, error: impl Fn(&Samples, usize, usize) -> f64) -> DVector<f64> {
    let exact = estimate(&case.robot, case, &case.samples).beta();
    let (n, mut squares) = (case.robot.dof(), exact.map(|_| 0.0));
    let coupling = case.robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
    for m in 0..n {
        let mut samples = case.samples.clone();
        for (k, tau) in samples.tau.chunks_exact_mut(n).enumerate() {
            // What the motor alone does to the joints: Cᵀ e_m.
            let mut motors = DVector::zeros(n);
            motors[m] = error(&case.samples, k, m);
            for (tau, by) in tau.iter_mut().zip(coupling.tr_mul(&motors).iter()) {
                *tau += by;
            }
        }
        let shift = estimate(&case.robot, case, &samples).beta() - &exact;
        squares += shift.component_mul(&shift);
    }
    squares.map(f64::sqrt)
}

#[test]
fn identity_a_torque_constant_moves_the_estimate_as_far_as_it_is_declared() {
    let case = case();
    let found = estimate(&declaring(&case.robot, "torque_constant", 0.03), &case, &case.samples);
    let expected = moved(&case, |samples, k, m| 0.03 * samples.tau[6 * k + m]);
    assert!((declared(&found) - &expected).amax() < 1e-9 * expected.amax());
    // It is added to the rest, in squares, and the estimate stays.
    let plain = estimate(&case.robot, &case, &case.samples);
    assert_eq!(found.beta(), plain.beta());
    assert!(declared(&plain).iter().all(|&std| std == 0.0));
    for ((found, plain), declared) in found.base.iter().zip(&plain.base).zip(expected.iter()) {
        assert!((found.std - plain.std.hypot(*declared)).abs() < 1e-9 * found.std, "{}", found.name);
    }
}

/// The last motor of this arm is driven through the one before it.
#[test]
fn identity_a_torque_constant_of_a_coupled_motor_moves_the_estimate_as_far_as_it_is_declared() {
    let mut rng = Seed::new(72).stream("arm", 0);
    let recipe = ChainRecipe { prismatic: 0.0, coupled: true, ..ChainRecipe::new(3) };
    let (robot, parameters) = recipe.draw(&mut rng);
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let (regressor, mut dynamics) =
        (JointTorqueRegressor::new(&robot, columns).unwrap(), Dynamics::new(&robot, &parameters));
    let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).unwrap();
    let (mut states, mut tau) = (States::new(3), vec![0.0; 3 * COUNT]);
    for (k, tau) in tau.chunks_exact_mut(3).enumerate() {
        let (mut q, mut qd, mut qdd) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for l in 1..=4 {
                let (w, phase) = (0.6 * f64::from(l), 1.3 * f64::from(l) + 2.1 * i as f64);
                let (s, c) = libm::sincos(w * k as f64 / 20.0 + phase);
                (q[i], qd[i], qdd[i]) = (q[i] + 0.4 * s, qd[i] + 0.4 * w * c, qdd[i] - 0.4 * w * w * s);
            }
        }
        dynamics.inverse(&q, &qd, &qdd, tau);
        states.push(&q, &qd, &qdd);
    }
    let mut samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 3], 20.0);
    let covariance = DMatrix::identity(3, 3) * 0.04;
    for (tau, noise) in samples.tau.iter_mut().zip(white(&covariance, COUNT, &mut rng).iter()) {
        *tau += noise;
    }
    samples.noise = Some(NoiseModel::white(covariance, false, 1e9));
    let of = robot.clone();
    let observe = Box::new(move |samples: &Samples| Observation::new(&of, &regressor, &base, samples).unwrap());
    let case = Case { robot, observe, samples };
    let coupling = case.robot.coupling().unwrap().clone();
    assert!(coupling != coupling.transpose());
    let found = estimate(&declaring(&case.robot, "torque_constant", 0.03), &case, &case.samples);
    let expected = moved(&case, |samples, k, m| {
        let joints = DVector::from_column_slice(&samples.tau[3 * k..3 * k + 3]);
        0.03 * coupling.transpose().lu().solve(&joints).unwrap()[m]
    });
    assert!((declared(&found) - &expected).amax() < 1e-9 * expected.amax());
}

#[test]
fn identity_a_lag_moves_the_estimate_as_far_as_it_is_declared() {
    let case = case();
    let found = estimate(&declaring(&case.robot, "current_lag_s", 1e-3), &case, &case.samples);
    let step = 1.0 / case.samples.rate_hz;
    let expected = moved(&case, |samples, k, m| {
        let at = |k: usize| samples.tau[6 * (k % COUNT) + m];
        1e-3 * (at(k + 1) - at(k + COUNT - 1)) / (2.0 * step)
    });
    assert!((declared(&found) - &expected).amax() < 1e-9 * expected.amax());
}

#[test]
fn what_is_declared_of_terms_has_the_keys_of_their_priors() {
    for key in DeclaredUncertainty::KEYS {
        let is_of_motors = [DeclaredUncertainty::TORQUE_CONSTANT, DeclaredUncertainty::CURRENT_LAG].contains(&key);
        assert_ne!(is_of_motors, Term::ALL.iter().any(|term| term.entry().prior.key == key), "{key}");
    }
}

#[test]
fn analytic_a_coefficient_that_is_meant_otherwise_is_uncertain_by_itself() {
    let case = case();
    let plain = estimate(&case.robot, &case, &case.samples);
    let observation = (case.observe)(&case.samples);
    let is = |row: usize, term: Term| matches!(observation.base.terms(row)[..], [(id, _)] if id.kind == ParameterKind::Term(term));
    let found = estimate(&declaring(&case.robot, "viscous", 0.2), &case, &case.samples);
    for (row, (p, declared)) in plain.base.iter().zip(declared(&found).iter()).enumerate() {
        let expected = if is(row, VISCOUS) { 0.2 * p.value.abs() } else { 0.0 };
        assert!((declared - expected).abs() < 1e-6 * (1.0 + p.value.abs()), "{}: {declared} {expected}", p.name);
    }
    let found = estimate(&declaring(&case.robot, "offset_nm", 0.5), &case, &case.samples);
    let offsets = found.base.iter().filter(|p| p.name.starts_with("Fo"));
    let stds: Vec<f64> = offsets.map(|p| p.declared_std).collect();
    assert!(stds.len() == 6 && stds.iter().all(|std| (std - 0.5).abs() < 1e-6), "{stds:?}");
}
