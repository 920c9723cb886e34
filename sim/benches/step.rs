//! How long the simulator takes: one servo step of the bundled six-axis arm, and one whole experiment.
//!
//! `cargo bench -p armid-sim` prints microseconds per step of 1 ms and seconds per experiment of 115 s of motion.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use std::num::NonZeroU32;
use std::time::Instant;

use armid::experiment::{Discarding, ExperimentPlan, Next, Plant, Servo, record};
use armid::model::bundled;
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::seed::Seed;
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid::trajectory::FourierTrajectory;
use armid_sim::{AnalyticPlant, BatchRun, RapierPlant, record_runs};

fn main() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("the A460 is bundled");
    let robot = parse_robot(entry.robot).expect("a valid robot");
    let nominal = parse_nominal(entry.nominal, &robot).expect("valid parameters").parameters;
    let truth = parse_parameters(truth_text(entry.name).expect("bundled"), &robot, true).expect("valid").parameters;
    let plant = AnalyticPlant::new(&robot, &truth).expect("six joints");

    let mut free = plant.clone();
    let mut acceleration = [0.0; 6];
    free.reset(&[0.3, 0.4, -0.2, 0.5, 0.6, 0.7], &[1.0, -0.8, 0.7, -1.2, 1.1, 0.9]);
    let count = 100_000;
    let mut best = f64::INFINITY;
    for _ in 0..10 {
        let begin = Instant::now();
        for k in 0..count {
            free.acceleration(&[f64::from(k) * 1e-6, 20.0, 5.0, 0.1, 0.2, 0.1], &mut acceleration);
        }
        best = best.min(begin.elapsed().as_secs_f64() * 1e9 / f64::from(count));
    }
    println!("forward dynamics with friction: {best:.0} ns");

    let mut batch = plant.batch(8);
    best = f64::INFINITY;
    for _ in 0..10 {
        for run in 0..8 {
            batch.reset(run, &[0.3, 0.4, -0.2, 0.5, 0.6, 0.7], &[1.0, -0.8, 0.7, -1.2, 1.1, 0.9]);
            batch.push(run, &[10.0, 20.0, 5.0, 2.0, 2.0, 1.0]);
        }
        let begin = Instant::now();
        for _ in 0..100 {
            batch.step(1e-3);
        }
        best = best.min(begin.elapsed().as_secs_f64() * 1e6 / 800.0);
    }
    println!("step of 1 ms, 8 runs together: {best:.2} µs for each run");
    best = f64::INFINITY;
    for _ in 0..10 {
        free.reset(&[0.3, 0.4, -0.2, 0.5, 0.6, 0.7], &[1.0, -0.8, 0.7, -1.2, 1.1, 0.9]);
        let begin = Instant::now();
        for _ in 0..100 {
            free.step(&[10.0, 20.0, 5.0, 2.0, 2.0, 1.0], 1e-3).expect("a motion");
        }
        best = best.min(begin.elapsed().as_secs_f64() * 1e6 / 100.0);
    }
    println!("step of 1 ms, alone: {best:.2} µs");

    // One step of 1 ms of each engine, in motion and with friction.
    let mut engines: Vec<(String, Box<dyn Plant>)> = vec![("analytic".to_owned(), Box::new(plant.clone()))];
    for substeps in [1, 4] {
        let substeps = NonZeroU32::new(substeps).expect("not zero");
        let engine = RapierPlant::new(&robot, &truth).expect("a consistent arm").with_substeps(substeps);
        engines.push((format!("rapier, {substeps} substeps"), Box::new(engine)));
    }
    for (name, mut engine) in engines {
        let count = 20_000;
        let mut seconds = 0.0;
        for _ in 0..count / 100 {
            engine.reset(&[0.3, 0.4, -0.2, 0.5, 0.6, 0.7], &[1.0, -0.8, 0.7, -1.2, 1.1, 0.9]);
            let begin = Instant::now();
            for _ in 0..100 {
                engine.step(&[1.0, 20.0, 5.0, 0.1, 0.2, 0.1], 1e-3).expect("a motion that is a number");
            }
            seconds += begin.elapsed().as_secs_f64();
        }
        println!("{name}: {:.0} ns per step of 1 ms", seconds * 1e9 / f64::from(count));
    }

    // The servo alone: its cycle on a plant that stands still.
    let still = ExperimentPlan::new(table_one::corrected());
    let servo = Servo::new(&robot, &nominal, plant.clone()).expect("the nominal arm has inertia");
    let mut cycle = servo.cycle(&still).expect("a plan that can be performed");
    let (q, qd) = (cycle.start().to_vec(), [0.0; 6]);
    let begin = Instant::now();
    let mut steps = 0;
    while cycle.advance(&q, &qd, &mut Discarding, &mut |_| {}) == Next::Step {
        steps += 1;
    }
    println!(
        "controller, sensors, phases: {:.0} ns per servo step",
        begin.elapsed().as_secs_f64() * 1e9 / f64::from(steps)
    );

    // Five-second period: as long as the main job's experiments, and Table I's speeds.
    let trajectory = table_one::corrected();
    let short = FourierTrajectory { period_s: 5.0, ..trajectory.clone() };
    for (name, trajectory) in [("period 10 s", trajectory), ("period 5 s", short)] {
        let plan = ExperimentPlan::new(trajectory);
        let mut best = f64::INFINITY;
        let mut steps = 0;
        let mut servo = Servo::new(&robot, &nominal, plant.clone()).expect("the nominal arm has inertia");
        for run in 0..5 {
            servo = servo.with_seed(Seed::new(1), run);
            let begin = Instant::now();
            let (recording, ending) = record(&mut servo, &plan).expect("a plan that can be performed");
            best = best.min(begin.elapsed().as_secs_f64());
            assert!(ending.is_complete());
            steps = recording.len();
        }
        println!(
            "{name}: {best:.3} s for an experiment of {:.0} s, {:.2} µs per servo step with sensors",
            steps as f64 * 1e-3,
            best * 1e6 / steps as f64
        );
        let runs: Vec<BatchRun<'_>> =
            (0..16).map(|run| BatchRun { plan: &plan, noise: Seed::new(1).of_run(run) }).collect();
        let begin = Instant::now();
        let together = record_runs(&servo, &runs);
        let each = begin.elapsed().as_secs_f64() / runs.len() as f64;
        assert!(together.iter().all(|run| run.as_ref().is_ok_and(|(_, ending)| ending.is_complete())));
        println!("{name}, 16 runs together: {each:.3} s for each, {:.2} µs per servo step", each * 1e6 / steps as f64);
    }
}
