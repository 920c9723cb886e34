//! The simulator against closed forms, its own order, and energy.
#![allow(clippy::unwrap_used, reason = "a test panics")]

use armid::model::term::{COULOMB, OFFSET, ROTOR, VISCOUS};
use std::f64::consts::{FRAC_PI_2, PI};

use armid::conformance::chains::{self, ChainRecipe};
use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::model::format::{parse_parameters, parse_robot};
use armid::model::{DriveParameters, Robot, RobotSpec, StandardParameters, bundled, smooth_sign};
use armid::seed::Seed;
use armid::spatial::Inertia;
use armid::study::truth_text;
use armid_sim::AnalyticPlant;
use nalgebra::{Matrix3, Vector3};

/// One link of the planar arm: a point mass of 1.5 kg, 0.4 m below its hinge when the coordinate is −90°.
fn pendulum() -> (Robot, StandardParameters) {
    let planar = chains::planar_2r();
    let robot = Robot::new(RobotSpec {
        name: "pendulum".to_owned(),
        gravity: Vector3::new(0.0, 0.0, -9.81),
        base: *planar.base(),
        joints: planar.joints()[..1].to_vec(),
        coupling: None,
        ..RobotSpec::default()
    })
    .unwrap();
    let mut parameters = StandardParameters::zero(1);
    parameters.links[0] = Inertia::from_com(1.5, Vector3::zeros(), Matrix3::zeros());
    (robot, parameters)
}

/// Arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..10 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

#[test]
fn analytic_a_pendulum_comes_back_after_its_elliptic_period() {
    let (robot, parameters) = pendulum();
    let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
    for amplitude in [0.1, 1.0, 2.5, 3.1] {
        // T = 2π / (ω agm(1, cos(θ/2))), ω² = g / l: the complete elliptic integral of the first kind.
        let period = 2.0 * PI / ((9.81_f64 / 0.4).sqrt() * agm(1.0, libm::cos(0.5 * amplitude)));
        let steps = 4000;
        let start = [-FRAC_PI_2 + amplitude];
        plant.reset(&start, &[0.0]);
        for _ in 0..steps / 2 {
            plant.step(&[0.0], period / f64::from(steps)).unwrap();
        }
        let middle = plant.state().0[0];
        assert!((middle - (-FRAC_PI_2 - amplitude)).abs() < 1e-9, "{amplitude}: {middle}");
        for _ in 0..steps / 2 {
            plant.step(&[0.0], period / f64::from(steps)).unwrap();
        }
        // h⁴ of 1e-13 at ω h = 1e-3, times the pendulum's sensitivity near its upper rest.
        assert!((plant.state().0[0] - start[0]).abs() < 1e-9 && plant.state().1[0].abs() < 1e-8, "{amplitude}");
    }
}

#[test]
fn analytic_a_sliding_joint_under_viscous_friction() {
    // v = τ/F (1 − exp(−F t / J)) for a flywheel of inertia J.
    let (robot, _) = pendulum();
    let robot = robot.with_gravity(Vector3::zeros());
    let mut parameters = StandardParameters::zero(1);
    parameters.drives[0] = DriveParameters::from_iter([(ROTOR, 0.7), (VISCOUS, 3.0), (OFFSET, -0.5)]);
    let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
    for _ in 0..500 {
        plant.step(&[2.0], 1e-3).unwrap();
    }
    let v = 2.5 / 3.0 * (1.0 - libm::exp(-3.0 * 0.5 / 0.7));
    // RK4 on λ h = 4e-3: (λh)⁴ / 120 of the decay.
    assert!((plant.state().1[0] - v).abs() < 1e-11);
}

/// State after `t` seconds in `steps` equal steps without friction.
fn end(plant: &mut AnalyticPlant, q: &[f64], qd: &[f64], tau: &[f64], t: f64, steps: u32) -> Vec<f64> {
    plant.reset(q, qd);
    for _ in 0..steps {
        plant.step(tau, t / f64::from(steps)).unwrap();
    }
    let (q, qd) = plant.state();
    [q, qd].concat()
}

#[test]
fn analytic_the_error_shrinks_with_the_fourth_power_of_the_step() {
    for run in 0..4 {
        let mut rng = Seed::new(8).stream("chains", run);
        let (robot, mut parameters) = ChainRecipe::new(3 + run as usize).draw(&mut rng);
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| term == ROTOR);
        }
        let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
        let (q, qd, tau) = chains::random_state(&mut rng, robot.dof());
        let reference = end(&mut plant, &q, &qd, &tau, 0.4, 3200);
        let mut error = |steps| {
            let other = end(&mut plant, &q, &qd, &tau, 0.4, steps);
            reference.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(100), error(200));
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.2, "chain {run}: order {order}, errors {coarse:e} {fine:e}");
    }
}

fn bundled_arm(name: &str) -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let truth = parse_parameters(truth_text(name).unwrap(), &robot, true).unwrap().parameters;
    (robot, truth)
}

#[test]
fn identity_energy_is_kept_without_friction_and_lost_at_its_rate_with_it() {
    let (robot, truth) = bundled_arm("crs-a460");
    let mut free = truth.clone();
    for drive in &mut free.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    let (q, qd) = ([0.3, 0.5, -0.4, 0.2, 0.7, 0.1], [0.5, -0.4, 0.8, 0.3, -0.6, 1.0]);
    let dynamics = Dynamics::new(&robot, &free);
    let mut plant = AnalyticPlant::new(&robot, &free).unwrap();
    let energy = |plant: &AnalyticPlant| dynamics.energy(plant.state().0, plant.state().1);
    plant.reset(&q, &qd);
    let start = energy(&plant).total();
    let mut most: f64 = 0.0;
    for _ in 0..5000 {
        plant.step(&[0.0; 6], 1e-3).unwrap();
        most = most.max(energy(&plant).kinetic);
    }
    // The arm falls about freely for 5 s; global error of order h⁴.
    assert!((energy(&plant).total() - start).abs() < 1e-8 * most, "{:e}", (energy(&plant).total() - start) / most);

    // With friction the loss is ∫ Σ q̇ (Fv q̇ + Fc sgn q̇ + Fo) dt, by Simpson's rule over pairs of steps.
    let mut plant = AnalyticPlant::new(&robot, &truth).unwrap();
    plant.reset(&q, &qd);
    let power = |plant: &AnalyticPlant| -> f64 {
        let speeds = plant.state().1;
        robot
            .joints()
            .iter()
            .zip(&truth.drives)
            .zip(speeds)
            .map(|((joint, drive), &v)| {
                let sign = smooth_sign(v, joint.drive.coulomb_velocity);
                v * (drive[VISCOUS] * v + drive[COULOMB] * sign + drive[OFFSET])
            })
            .sum()
    };
    let (mut loss, h) = (0.0, 2.5e-4);
    for _ in 0..2000 {
        let first = power(&plant);
        plant.step(&[0.0; 6], h).unwrap();
        let middle = power(&plant);
        plant.step(&[0.0; 6], h).unwrap();
        loss += h / 3.0 * (first + 4.0 * middle + power(&plant));
    }
    let lost = start - energy(&plant).total();
    // Simpson's rule across turning points of stiff friction.
    assert!(loss > 1.0 && (lost - loss).abs() < 2e-6 * loss, "{lost} {loss}");
}

#[test]
fn analytic_below_its_coulomb_friction_a_joint_creeps_without_chatter() {
    // With gravity off, a torque of half the Coulomb friction ends at the speed where Fv v + Fc tanh(v / v_s) takes it:
    // no oscillation at 1 ms, although friction is as stiff as 1e4 1/s there.
    for name in ["crs-a460", "puma-560", "staubli-tx40"] {
        let (robot, truth) = bundled_arm(name);
        let robot = robot.with_gravity(Vector3::zeros());
        let mut plant = AnalyticPlant::new(&robot, &truth).unwrap();
        let tau: Vec<f64> = truth.drives.iter().map(|drive| 0.5 * drive[COULOMB] + drive[OFFSET]).collect();
        plant.reset(&vec![0.4; robot.dof()], &vec![0.0; robot.dof()]);
        let mut before = vec![0.0; robot.dof()];
        for k in 0..400 {
            plant.step(&tau, 1e-3).unwrap();
            let speeds = plant.state().1;
            if k >= 300 {
                for (v, w) in speeds.iter().zip(&before) {
                    // What is left is the arm's slow change of pose, not a step-to-step oscillation.
                    assert!((v - w).abs() < 2e-7, "{name}: {v} after {w}");
                }
            }
            before.copy_from_slice(speeds);
        }
        if robot.coupling().is_none() {
            for (i, drive) in truth.drives.iter().enumerate() {
                let v_s = robot.joints()[i].drive.coulomb_velocity;
                let v = plant.state().1[i];
                let taken = drive[VISCOUS] * v + drive[COULOMB] * smooth_sign(v, v_s);
                assert!((taken - 0.5 * drive[COULOMB]).abs() < 1e-4 * drive[COULOMB], "{name} joint {}", i + 1);
            }
        }
    }
}

/// The state after `t` by the classical method in `steps` on the core's equations of motion, in which nothing is held.
fn reference(dynamics: &mut Dynamics, (q, qd): (&[f64], &[f64]), tau: &[f64], t: f64, steps: u32) -> Vec<f64> {
    let n = q.len();
    let h = t / f64::from(steps);
    let mut rate = |y: &[f64]| {
        let mut out = y[n..].to_vec();
        out.resize(2 * n, 0.0);
        dynamics.forward(&y[..n], &y[n..], tau, &mut out[n..]);
        out
    };
    let ahead = |y: &[f64], k: &[f64], h: f64| -> Vec<f64> { y.iter().zip(k).map(|(y, k)| y + h * k).collect() };
    let mut y = [q, qd].concat();
    for _ in 0..steps {
        let k1 = rate(&y);
        let k2 = rate(&ahead(&y, &k1, 0.5 * h));
        let k3 = rate(&ahead(&y, &k2, 0.5 * h));
        let k4 = rate(&ahead(&y, &k3, h));
        for i in 0..2 * n {
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
    y
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn analytic_steps_through_stiff_friction_are_near_the_exact_ones() {
    // Single steps of 1 ms from states at rest or near a reversal of some joint, pushed by up to 1.5 times the friction. What is left
    // is the error of friction's parts, which is of order four.
    for name in ["crs-a460", "puma-560", "staubli-tx40"] {
        let (robot, truth) = bundled_arm(name);
        let n = robot.dof();
        let mut dynamics = Dynamics::new(&robot, &truth);
        let mut plant = AnalyticPlant::new(&robot, &truth).unwrap();
        let mut errors = [0.0_f64; 4];
        for k in 0..40_u32 {
            let wave = |i: usize, rate: f64| libm::sin(rate * f64::from(k) + 1.7 * i as f64);
            let q: Vec<f64> = (0..n).map(|i| 0.2 * wave(i, 0.9) + 0.4).collect();
            let moves = |i: usize| k % 2 == 1 && (i + k as usize).is_multiple_of(3);
            let qd: Vec<f64> = (0..n).map(|i| if moves(i) { 1.0 } else { 0.0 } + 0.02 * wave(i, 2.3)).collect();
            let mut tau = vec![0.0; n];
            dynamics.inverse(&q, &qd, &vec![0.0; n], &mut tau);
            for (i, tau) in tau.iter_mut().enumerate() {
                *tau += 1.5 * truth.drives[i][COULOMB] * wave(i, 3.1);
            }
            let exact = reference(&mut dynamics, (&q, &qd), &tau, 1e-3, 400);
            for (error, steps) in errors.iter_mut().zip([1, 10, 40, 80]) {
                *error = error.max(largest_difference(&end(&mut plant, &q, &qd, &tau, 1e-3, steps), &exact));
            }
        }
        assert!(errors[0] < 1e-4 && errors[1] < 5e-5, "{name}: {errors:?}");
        assert!(errors[2] < 5e-6 && errors[2] > 12.0 * errors[3], "{name}: {errors:?}");
    }
}

#[test]
fn analytic_a_rigid_part_that_is_held_errs_little_and_less_in_shorter_steps() {
    // One joint creeps under friction of some 2e4 1/s, which divides every step. The others have none. Their error is of order two;
    // the speed that creeps is that of the middle's forces, half a step late, and so of order one.
    for run in 0..4 {
        let mut rng = Seed::new(19).stream("chains", run);
        let (robot, mut parameters) = ChainRecipe::new(4).draw(&mut rng);
        let creeping = run as usize;
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| term == ROTOR);
        }
        let (q, mut qd, tau) = chains::random_state(&mut rng, robot.dof());
        qd[creeping] = 0.0;
        let mut accelerations = [vec![0.0; 4], vec![0.0; 4]];
        for (pushed, qdd) in accelerations.iter_mut().enumerate() {
            let mut tau = tau.clone();
            tau[creeping] += pushed as f64;
            Dynamics::new(&robot, &parameters).forward(&q, &qd, &tau, qdd);
        }
        let mobility = accelerations[1][creeping] - accelerations[0][creeping];
        let v_s = robot.joints()[creeping].drive.coulomb_velocity;
        let rotor = parameters.drives[creeping][ROTOR];
        parameters.drives[creeping] = DriveParameters::from_iter([(ROTOR, rotor), (COULOMB, 2e4 * v_s / mobility)]);
        let mut dynamics = Dynamics::new(&robot, &parameters);
        let mut plant = AnalyticPlant::new(&robot, &parameters).unwrap();
        let settled = end(&mut plant, &q, &qd, &tau, 2e-3, 200);
        let (q, qd) = settled.split_at(robot.dof());
        assert!(qd[creeping].abs() < v_s, "{qd:?}");
        let exact = reference(&mut dynamics, (q, qd), &tau, 4e-3, 2000);
        let mut error = |steps| largest_difference(&end(&mut plant, q, qd, &tau, 4e-3, steps), &exact);
        let (coarse, fine) = (error(4), error(8));
        assert!(coarse < 1e-7 && fine < 0.6 * coarse, "chain {run}: errors {coarse:e} {fine:e}");
    }
}
