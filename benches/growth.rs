//! How cost grows, on one core: with joints, samples, harmonics. `cargo bench -p armid --bench growth` prints lines of
//! figure, series, size and seconds, which `benches/peers/growth.py` draws.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

use armid::base::{Method, reduce};
use armid::conformance::chains;
use armid::dynamics::{Dynamics, States};
use armid::estimation::{EstimatorKind, Identification};
use armid::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem, DesignSpace, design};
use armid::model::{Columns, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::Samples;
use armid::trajectory::Family;
use nalgebra::DMatrix;
use rand::RngExt;

const COLUMNS: Columns = Columns::RIGID_ROTOR_FRICTION;

fn print(figure: &str, series: &str, size: usize, seconds: f64) {
    println!("{figure}\t{series}\t{size}\t{seconds:e}");
}

/// The fastest of as many repeats as fit in about a fifth of a second, at least one, s.
fn best<T>(mut run: impl FnMut() -> T) -> f64 {
    let (began, mut best) = (Instant::now(), f64::INFINITY);
    while best.is_infinite() || began.elapsed().as_secs_f64() < 0.2 {
        let once = Instant::now();
        black_box(run());
        best = best.min(once.elapsed().as_secs_f64());
    }
    best
}

fn chain(dof: usize) -> (Robot, StandardParameters) {
    chains::random_robot(&mut Seed::new(1).stream("growth", 0), dof)
}

fn random_states(dof: usize, count: usize) -> States {
    let mut rng = Seed::new(2).stream("growth", 0);
    let mut states = States::new(dof);
    for _ in 0..count {
        let (q, qd, qdd) = chains::random_state(&mut rng, dof);
        states.push(&q, &qd, &qdd);
    }
    states
}

fn main() {
    for dof in [2, 3, 4, 6, 8, 12, 16, 24, 32, 40] {
        evaluations(dof);
        reductions(dof);
    }
    let (robot, parameters) = chain(6);
    for count in [300, 1000, 3000, 10_000, 30_000, 100_000, 300_000] {
        samples(&robot, &parameters, count);
    }
    for harmonics in [2, 3, 5, 8, 12, 16] {
        designs("harmonics", &robot, harmonics, harmonics);
    }
    for dof in [2, 3, 4, 6, 8, 10] {
        designs("design-joints", &chain(dof).0, 5, dof);
    }
}

/// One evaluation of each.
fn evaluations(dof: usize) {
    const STATES: usize = 64;
    let (robot, parameters) = chain(dof);
    let states = random_states(dof, STATES);
    let each = |series: &str, seconds: f64| print("joints", series, dof, seconds / STATES as f64);
    let mut dynamics = Dynamics::new(&robot, &parameters);
    let mut out = vec![0.0; dof];
    each(
        "inverse dynamics",
        best(|| {
            (0..STATES).for_each(|k| dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut out));
        }),
    );
    each(
        "forward dynamics",
        best(|| {
            (0..STATES).for_each(|k| dynamics.forward(states.q(k), states.qd(k), states.qdd(k), &mut out));
        }),
    );
    let regressor = JointTorqueRegressor::new(&robot, COLUMNS).expect("columns of motion");
    let mut y = vec![0.0; regressor.rows() * regressor.cols()];
    let alone = best(|| (0..STATES).for_each(|k| regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y)));
    each("regressor", alone);
    let all: Vec<usize> = (0..regressor.cols()).collect();
    let mut w = DMatrix::zeros(dof * STATES, all.len());
    each("regressor in lanes", best(|| regressor.stack_means_into(&states, &all, 1, &mut w)));
}

fn reductions(dof: usize) {
    let (robot, _) = chain(dof);
    for (series, method) in [("paper", Method::Radkhah2007), ("qr", Method::Qr), ("structural", Method::Structural)] {
        print(
            "reduction",
            series,
            dof,
            best(|| reduce(&robot, COLUMNS, method, Seed::new(1)).expect("a finite geometry")),
        );
    }
}

/// The regressor of a recording, and the way from its states to weighted estimates with intervals.
fn samples(robot: &Robot, parameters: &StandardParameters, count: usize) {
    let n = robot.dof();
    let states = random_states(n, count);
    let (mut rng, mut dynamics) = (Seed::new(3).stream("growth", 0), Dynamics::new(robot, parameters));
    let mut tau = vec![0.0; n * count];
    for (k, tau) in tau.chunks_exact_mut(n).enumerate() {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), tau);
        tau.iter_mut().for_each(|tau| *tau += rng.random_range(-1.0..1.0));
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); n], 100.0);
    let identification = Identification::new(robot, COLUMNS).expect("a chain has a base");
    let regressor = JointTorqueRegressor::new(robot, COLUMNS).expect("columns of motion");
    print("samples", "stack", count, best(|| regressor.stack_means(&samples.states, &identification.base().kept, 1)));
    for (series, estimator) in [("ols", EstimatorKind::Ols), ("wls", EstimatorKind::Wls)] {
        let estimate = || identification.estimate(&samples, estimator.estimator()).expect("random states excite all");
        print("samples", series, count, best(estimate));
    }
}

/// One start of a hundred evaluations of the criterion, every limit of a trajectory held.
fn designs(figure: &str, robot: &Robot, harmonics: usize, size: usize) {
    for criterion in [CriterionKind::Condition, CriterionKind::DOptimal] {
        let mut problem =
            DesignProblem::new(robot.clone(), COLUMNS, criterion, DesignLimits::motion()).expect("a chain has a base");
        problem
            .set_space(DesignSpace::new(Family::Fourier, 10.0, vec![harmonics; robot.dof()]))
            .expect("a space that is possible");
        problem.set_budget(DesignBudget { evaluations: 100, ..DesignBudget::default() }).expect("not zero");
        print(
            figure,
            criterion.name(),
            size,
            best(|| design(&problem, Seed::new(1), 0).expect("a problem that is possible")),
        );
    }
}
