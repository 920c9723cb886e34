//! The fit of a model's own terms on simulated logs.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::bodies::{Body, FLOOR};
use super::equations::NormalEquations;
use super::fit::LogEquations;
use super::{ModelFit, ModelGuess, fit_model};
use crate::chains::random_robot;
use crate::dynamics::{Dynamics, States};
use crate::estimation::{Model, Termination};
use crate::model::term::{COULOMB, LOAD_FRICTION, OFFSET, ROTOR, VISCOUS};
use crate::model::{Columns, DriveParameters, Robot, StandardParameters};
use crate::observer::Unobserved;
use crate::seed::Seed;
use crate::signal::Samples;
use crate::spatial::Inertia;

const JOINTS: usize = 4;

fn urdf() -> Columns {
    Columns::RIGID.with_term(VISCOUS).with_term(COULOMB)
}

/// An arm with a plain sign of friction, what its file says of the bodies (masses off by up to 40 %, no drive), and what it is.
fn arm(run: u64) -> (Robot, StandardParameters, StandardParameters) {
    let mut rng = Seed::new(91).stream("model fit", run);
    let (robot, stated) = random_robot(&mut rng, JOINTS);
    let robot = robot.with_joints(|joint| joint.drive.coulomb_velocity = 0.0).unwrap();
    let stated = stated.links_alone();
    let mut truth = stated.clone();
    for link in &mut truth.links {
        let factor = rng.random_range(0.7..1.4);
        *link = Inertia::from_array(&link.to_array().map(|x| factor * x));
    }
    for drive in &mut truth.drives {
        *drive =
            DriveParameters::from_iter([(VISCOUS, rng.random_range(0.5..2.0)), (COULOMB, rng.random_range(0.5..2.0))]);
    }
    (robot, stated, truth)
}

/// Torque along harmonics of this amplitude (rad), with white noise of a part of each joint's RMS.
fn log(robot: &Robot, truth: &StandardParameters, amplitude: f64, noise: f64, run: u64) -> Samples {
    let mut rng = Seed::new(92).stream("log of a model fit", run);
    let count = 1500;
    let waves: Vec<[f64; 3]> = (0..3 * JOINTS)
        .map(|k| {
            [(k % 3 + 1) as f64 * rng.random_range(0.6..1.4), rng.random_range(0.0..6.0), rng.random_range(0.3..1.0)]
        })
        .collect();
    let (mut states, mut tau) = (States::new(JOINTS), Vec::new());
    let mut dynamics = Dynamics::new(robot, truth);
    for k in 0..count {
        let t = k as f64 * 0.01;
        let (mut q, mut qd, mut qdd) = ([0.0; JOINTS], [0.0; JOINTS], [0.0; JOINTS]);
        for (at, [w, phase, size]) in waves.iter().enumerate() {
            let (i, a) = (at % JOINTS, amplitude * size);
            q[i] += a * libm::sin(w * t + phase);
            qd[i] += a * w * libm::cos(w * t + phase);
            qdd[i] -= a * w * w * libm::sin(w * t + phase);
        }
        let mut one = [0.0; JOINTS];
        dynamics.inverse(&q, &qd, &qdd, &mut one);
        states.push(&q, &qd, &qdd);
        tau.extend(one);
    }
    for i in 0..JOINTS {
        let rms = (tau.iter().skip(i).step_by(JOINTS).map(|x| x * x).sum::<f64>() / count as f64).sqrt();
        tau.iter_mut().skip(i).step_by(JOINTS).for_each(|x| {
            let draw: f64 = StandardNormal.sample(&mut rng);
            *x += noise * rms * draw;
        });
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); JOINTS], 100.0)
}

/// Error over the torque of all joints.
fn error(robot: &Robot, parameters: &StandardParameters, samples: &Samples) -> f64 {
    let predicted = Model { robot, parameters }.predict(&samples.states).unwrap();
    let (mut sum, mut all) = (0.0, 0.0);
    for (predicted, measured) in predicted.iter().zip(&samples.tau) {
        sum += (measured - predicted).powi(2);
        all += measured * measured;
    }
    (sum / all).sqrt()
}

fn fitted(robot: &Robot, columns: Columns, samples: &Samples, stated: &StandardParameters) -> ModelFit {
    let fit = fit_model(robot, columns, samples, &ModelGuess::new(robot, Some(stated), &[]), &Unobserved).unwrap();
    assert!(matches!(fit.termination, Termination::Optimal { .. }), "{:?}", fit.termination);
    fit
}

/// The smallest eigenvalue of each body relative to its guess.
fn least(found: &Inertia, guess: &Inertia) -> f64 {
    let inverse = guess.pseudo().0.cholesky().unwrap().l().try_inverse().unwrap();
    nalgebra::SymmetricEigen::new(inverse * found.pseudo().0 * inverse.transpose()).eigenvalues.min()
}

#[test]
fn identity_a_wide_motion_without_noise_gives_the_torque_of_the_arm() {
    for run in 0..4 {
        let (robot, stated, truth) = arm(run);
        let samples = log(&robot, &truth, 1.0, 0.0, run);
        let fit = fitted(&robot, urdf(), &samples, &stated);
        let (found, other) = (error(&robot, &fit.parameters, &samples), log(&robot, &truth, 0.8, 0.0, run + 100));
        // The file of the arm is off; a residual below a thousandth weighs no more.
        assert!(error(&robot, &stated, &samples) > 0.01 && found < 2e-3, "{run}: {found}");
        assert!(error(&robot, &fit.parameters, &other) < 5e-3, "{run}: {}", error(&robot, &fit.parameters, &other));
        for (found, expected) in fit.parameters.drives.iter().zip(&truth.drives) {
            assert!(
                (found[VISCOUS] - expected[VISCOUS]).abs() < 0.05 && (found[COULOMB] - expected[COULOMB]).abs() < 0.05
            );
        }
    }
}

#[test]
fn identity_bodies_stay_bodies_where_the_motion_is_narrow_and_the_torque_has_an_offset() {
    for run in 0..4 {
        let (robot, stated, mut truth) = arm(run);
        truth.drives.iter_mut().for_each(|drive| drive[OFFSET] = 1.0);
        let samples = log(&robot, &truth, 0.1, 0.02, run);
        let fit = fitted(&robot, urdf(), &samples, &stated);
        for (index, (found, guess)) in fit.parameters.links.iter().zip(&stated.links).enumerate() {
            assert!(least(found, guess) > FLOOR, "{run} {index}: {}", least(found, guess));
            let ratio = found.mass / guess.mass;
            let bound = if index + 1 == JOINTS { 100.0 } else { 10.0 };
            assert!(1.0 / bound < ratio && ratio < bound, "{run} {index}: {ratio}");
        }
        assert!(fit.parameters.drives.iter().all(|drive| drive[VISCOUS] >= 0.0 && drive[COULOMB] >= 0.0));
        // What the file says is no better than what was found.
        assert!(error(&robot, &fit.parameters, &samples) < error(&robot, &stated, &samples));
        // All terms: the offset takes its share.
        let all = fitted(&robot, Columns::RIGID_ROTOR_FRICTION, &samples, &stated);
        assert!(error(&robot, &all.parameters, &samples) < 0.03, "{}", error(&robot, &all.parameters, &samples));
    }
}

#[test]
fn identity_a_rotor_that_the_file_does_not_state_is_found_and_leaves_the_links_alone() {
    let (robot, stated, _) = arm(5);
    let mut truth = stated.clone();
    for drive in &mut truth.drives {
        *drive = DriveParameters::from_iter([(VISCOUS, 1.0), (COULOMB, 0.5), (ROTOR, 0.5)]);
    }
    let samples = log(&robot, &truth, 1.0, 0.02, 5);
    let fit = fitted(&robot, urdf().with_term(ROTOR), &samples, &stated);
    for (drive, (found, guess)) in fit.parameters.drives.iter().zip(fit.parameters.links.iter().zip(&stated.links)) {
        assert!((drive[ROTOR] - 0.5).abs() < 0.1, "{drive:?}");
        assert!((0.7..1.4).contains(&(found.mass / guess.mass)), "{} {}", found.mass, guess.mass);
    }
}

#[test]
fn identity_friction_of_the_load_rests_at_that_of_the_arm() {
    let (robot, stated, mut truth) = arm(9);
    let robot = robot.with_joints(|joint| joint.drive.coulomb_velocity = 0.02).unwrap();
    truth.drives.iter_mut().for_each(|drive| drive[LOAD_FRICTION] = 0.1);
    let samples = log(&robot, &truth, 1.0, 0.01, 9);
    let fit = fitted(&robot, urdf().with_term(LOAD_FRICTION), &samples, &stated);
    for drive in &fit.parameters.drives {
        assert!((drive[LOAD_FRICTION] - 0.1).abs() < 0.05, "{drive:?}");
    }
    assert!(error(&robot, &fit.parameters, &samples) < 0.015, "{}", error(&robot, &fit.parameters, &samples));
}

#[test]
fn a_coefficient_that_no_row_shows_stays_as_the_file_has_it() {
    let (robot, mut stated, truth) = arm(6);
    stated.drives[1][VISCOUS] = 7.0;
    let mut samples = log(&robot, &truth, 0.5, 0.01, 6);
    samples.used.iter_mut().skip(1).step_by(JOINTS).for_each(|used| *used = false);
    let fit = fitted(&robot, urdf(), &samples, &stated);
    assert!((fit.parameters.drives[1][VISCOUS] - 7.0).abs() < 1e-12 && fit.parameters.drives[1][COULOMB] == 0.0);
}

#[test]
fn identity_the_divergence_is_least_at_the_guess_and_has_its_slope_and_curvature() {
    let (_, stated, _) = arm(7);
    let body = Body::around(0, &stated.links[2], (0.1, 10.0)).unwrap();
    let centre = Body::centre();
    assert!(body.divergence(&centre).unwrap().gradient.amax() < 1e-12);
    let mut rng = Seed::new(93).stream("divergence", 0);
    for _ in 0..5 {
        let x = centre + super::bodies::Ten::from_fn(|_, _| rng.random_range(-0.2..0.2));
        let way = super::bodies::Ten::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let (here, h) = (body.divergence(&x).unwrap(), 1e-5);
        let [ahead, behind] = [h, -h].map(|h| body.divergence(&(x + way * h)).unwrap());
        assert!(((ahead.value - behind.value) / (2.0 * h) - here.gradient.dot(&way)).abs() < 1e-6);
        assert!(((ahead.gradient - behind.gradient) / (2.0 * h) - here.hessian * way).amax() < 1e-5);
    }
}

#[test]
fn identity_no_nearby_set_has_a_smaller_objective() {
    let (robot, stated, truth) = arm(8);
    let samples = log(&robot, &truth, 0.3, 0.05, 8);
    let guess = ModelGuess::new(&robot, Some(&stated), &[]);
    let equations = LogEquations::of(&stated, &robot, urdf(), &samples, &guess).unwrap();
    let all = NormalEquations::sum(&equations.blocks(&[1.0; JOINTS]));
    let p = all.moment.len();
    let minimum = equations.prior.minimise(&all, 3.0, &equations.prior.centre(p));
    let value = |x: &nalgebra::DVector<f64>| {
        let (mut gradient, mut hessian) = (nalgebra::DVector::zeros(p), nalgebra::DMatrix::zeros(p, p));
        let bodies = equations.prior.bodies.iter().map(|body| body.add(3.0, x, &mut gradient, &mut hessian));
        let bodies: Option<f64> = bodies.sum();
        let (mut gradient, mut hessian) = (gradient.clone(), hessian.clone());
        let terms = equations.prior.coefficients.iter().map(|one| one.add(3.0, x, &mut gradient, &mut hessian));
        Some(0.5 * all.misfit(x) + bodies? + terms.sum::<Option<f64>>()?)
    };
    let best = value(&minimum.x).unwrap();
    let mut rng = Seed::new(94).stream("nearby", 0);
    for _ in 0..200 {
        let size = libm::pow(10.0, rng.random_range(-4.0..-1.0));
        let other = &minimum.x + nalgebra::DVector::from_fn(p, |_, _| size * rng.random_range(-1.0..1.0));
        assert!(value(&other).is_none_or(|value| value >= best - 1e-8), "{size}");
    }
}
