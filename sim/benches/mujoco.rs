//! What a step of 1 ms costs: MuJoCo's own, the plant around it, the analytic plant and rapier's, on the bundled
//! six-axis arm.
//!
//! `cargo bench -p armid-sim --bench mujoco` prints nanoseconds, the best of several rounds, and ratios. Needs MuJoCo:
//! `scripts/get-mujoco`.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use armid::dynamics::Dynamics;
use armid::model::term::ROTOR;
use std::num::NonZeroU32;
use std::time::Instant;

use armid::experiment::{Discarding, ExperimentPlan, Next, Plant, Servo};
use armid::model::bundled;
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid_sim::{AnalyticPlant, MujocoModel, MujocoPlant, MujocoScheme, MujocoStepper, RapierPlant};

/// Steps before the arm is put back; far from rest all the while.
const BLOCK: usize = 200;
/// Blocks of a round.
const BLOCKS: usize = 40;
/// Runs in lanes.
const RUNS: usize = 8;
/// Rounds, the best of which counts.
const ROUNDS: usize = 15;

const Q: [f64; 6] = [0.3, 0.4, -0.2, 0.5, 0.6, 0.7];
const QD: [f64; 6] = [1.0, -0.8, 0.7, -1.2, 1.1, 0.9];
/// About what holds the arm and overcomes friction, so that no joint comes to rest within a block.
const TAU: [f64; 6] = [9.0, -45.0, 5.0, -2.0, 2.0, 1.0];

/// A name, and one step of what is timed.
type Candidate<'a> = (&'static str, Box<dyn FnMut(bool) + 'a>);

/// Nanoseconds per step, `put_back` not counted; the rounds of all candidates alternate, so that a busy moment of the
/// machine meets them all.
fn race(candidates: &mut [Candidate<'_>]) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; candidates.len()];
    for _ in 0..ROUNDS {
        for ((_, step), best) in candidates.iter_mut().zip(&mut best) {
            let mut seconds = 0.0;
            for _ in 0..BLOCKS {
                step(true);
                let begin = Instant::now();
                for _ in 0..BLOCK {
                    step(false);
                }
                seconds += begin.elapsed().as_secs_f64();
            }
            *best = best.min(seconds * 1e9 / (BLOCK * BLOCKS) as f64);
        }
    }
    best
}

/// Velocities and torque.
type Held = ([f64; 6], [f64; 6]);

/// Steps a plant in motion, or puts it back.
fn stepper(plant: impl Plant) -> impl FnMut(bool) {
    stepper_held(plant, (QD, TAU))
}

fn stepper_held(mut plant: impl Plant, (qd, tau): Held) -> impl FnMut(bool) {
    move |put_back| {
        if put_back {
            plant.reset(&Q, &qd);
        } else {
            plant.step(&tau, 1e-3).expect("a finite motion");
        }
    }
}

/// Steps as many runs as a study computes together, or puts them back.
fn lanes(plant: &AnalyticPlant, (qd, tau): Held) -> impl FnMut(bool) + use<> {
    let mut batch = plant.batch(RUNS);
    move |put_back| {
        if put_back {
            for run in 0..RUNS {
                batch.reset(run, &Q, &qd);
                batch.push(run, &tau);
            }
        } else {
            batch.step(1e-3);
        }
    }
}

/// Steps MuJoCo, or puts it back.
fn own_step(mut model: MujocoModel, how: MujocoStepper) -> impl FnMut(bool) {
    move |put_back| {
        if put_back {
            model.reset();
            model.set_state(&Q, &QD);
            model.apply(&TAU);
        } else {
            model.step(how, 1e-3);
        }
    }
}

fn main() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("the A460 is bundled");
    let robot = parse_robot(entry.robot).expect("a valid robot");
    let nominal = parse_nominal(entry.nominal, &robot).expect("valid parameters").parameters;
    let truth = parse_parameters(truth_text(entry.name).expect("bundled"), &robot, true).expect("valid").parameters;
    let mut smooth = truth.clone();
    for drive in &mut smooth.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    let mujoco = |parameters| MujocoPlant::new(&robot, parameters).unwrap_or_else(|fault| panic!("{fault}"));
    let model = || MujocoModel::new(&robot, &truth).unwrap_or_else(|fault| panic!("{fault}"));
    let analytic = |parameters| AnalyticPlant::new(&robot, parameters).expect("six joints");
    let rapier = |parameters| RapierPlant::new(&robot, parameters).expect("a consistent arm");

    // The servo alone: its cycle on a plant that stands still.
    let plan = ExperimentPlan::new(table_one::corrected());
    let servo = Servo::new(&robot, &nominal, analytic(&truth)).expect("the nominal arm has inertia");
    let mut cycle = servo.cycle(&plan).expect("a plan that can be performed");
    let start = cycle.start().to_vec();
    let mut resting = analytic(&truth);
    resting.reset(&Q, &QD);
    let mut acceleration = [0.0; 6];
    // Held against gravity, where friction is stiffest.
    let mut rest = ([0.0; 6], [0.0; 6]);
    Dynamics::new(&robot, &truth).inverse(&Q, &[0.0; 6], &[0.0; 6], &mut rest.1);

    let mut candidates: Vec<Candidate<'_>> = vec![
        ("MuJoCo's Euler step, no friction", Box::new(own_step(model(), MujocoStepper::Euler))),
        ("MuJoCo's RK4 step, no friction", Box::new(own_step(model(), MujocoStepper::RungeKutta))),
        ("MuJoCo plant, stages, no friction", Box::new(stepper(mujoco(&smooth)))),
        ("MuJoCo plant, stages", Box::new(stepper(mujoco(&truth)))),
        ("MuJoCo plant, held RK4", Box::new(stepper(mujoco(&truth).with_scheme(MujocoScheme::HeldRungeKutta)))),
        ("MuJoCo plant, held Euler", Box::new(stepper(mujoco(&truth).with_scheme(MujocoScheme::HeldEuler)))),
        ("analytic plant's RK4 step, no friction", Box::new(stepper(analytic(&smooth)))),
        ("analytic plant's RK4 step", Box::new(stepper(analytic(&truth)))),
        ("analytic plant, 8 runs in lanes, no friction", Box::new(lanes(&analytic(&smooth), (QD, TAU)))),
        ("analytic plant, 8 runs in lanes", Box::new(lanes(&analytic(&truth), (QD, TAU)))),
        (
            "analytic forward dynamics",
            Box::new(move |_| resting.acceleration(std::hint::black_box(&TAU), &mut acceleration)),
        ),
        (
            "servo: controller, sensors, phases",
            Box::new(move |put_back| {
                if !put_back && cycle.advance(&start, &[0.0; 6], &mut Discarding, &mut |_| {}) != Next::Step {
                    cycle = servo.cycle(&plan).expect("a plan that can be performed");
                }
            }),
        ),
        ("rapier plant, 1 substep, no friction", Box::new(stepper(rapier(&smooth).with_substeps(NonZeroU32::MIN)))),
        ("rapier plant, 4 substeps", Box::new(stepper(rapier(&truth)))),
        ("analytic plant's RK4 step, at rest", Box::new(stepper_held(analytic(&truth), rest))),
        ("analytic plant, 8 runs in lanes, at rest", Box::new(lanes(&analytic(&truth), rest))),
    ];
    let mut cost = race(&mut candidates);
    for of_all in [8, 9, 15] {
        cost[of_all] /= RUNS as f64;
    }
    for ((name, _), cost) in candidates.iter().zip(&cost) {
        println!("{name:<44} {cost:>8.0} ns");
    }
    let ratio = |name: &str, own: f64, other: f64| println!("{name:<68} {:>6.3}", own / other);
    ratio("analytic forward dynamics + servo : MuJoCo's Euler step", cost[10] + cost[11], cost[0]);
    ratio("analytic RK4 step : MuJoCo's RK4 step, both without friction", cost[6], cost[1]);
    ratio("analytic RK4 step with friction : MuJoCo's RK4 step without", cost[7], cost[1]);
    ratio("RK4 step in lanes, each run : MuJoCo's RK4 step, no friction", cost[8], cost[1]);
    ratio("RK4 step in lanes with friction, each run : MuJoCo's RK4 step without", cost[9], cost[1]);
    ratio("MuJoCo plant by stages : MuJoCo's RK4 step, both without friction", cost[2], cost[1]);
    ratio("MuJoCo plant by stages : analytic plant, both with friction", cost[3], cost[7]);
    ratio("analytic RK4 step : rapier's step of order one, both without friction", cost[6], cost[12]);
    ratio("analytic RK4 step : rapier plant of 4 substeps, both with friction", cost[7], cost[13]);
    ratio("RK4 step in lanes, each run, at rest : in motion", cost[15], cost[9]);
}
