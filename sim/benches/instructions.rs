//! Fixed pieces of work, one for each thing that must stay fast: `cargo bench -p armid-sim --bench instructions` prints the time of
//! each; with a name and a number it does that piece so many times and prints nothing, for `scripts/instruction-counts`, which
//! counts instructions. Neither states nor seeds ever differ.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

use armid::base::{BaseReduction, Method, reduce};
use armid::conformance::chains;
use armid::dynamics::{Dynamics, States};
use armid::estimation::{EstimatorKind, Identification};
use armid::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem, design};
use armid::experiment::{ExperimentPlan, Servo, record};
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::observer::Unobserved;
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::Samples;
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid::trajectory::FourierTrajectory;
use armid_sim::{AnalyticPlant, BatchRun, record_runs};
use rand::RngExt;

const STATES: usize = 256;

/// A piece of work: its name, what is counted of it and how many of those one call does, and the call.
struct Piece<'a> {
    name: &'static str,
    unit: &'static str,
    of: usize,
    run: Box<dyn FnMut() + 'a>,
}

impl<'a> Piece<'a> {
    fn new(name: &'static str, unit: &'static str, of: usize, run: impl FnMut() + 'a) -> Self {
        Self { name, unit, of, run: Box::new(run) }
    }
}

struct Arm {
    robot: Robot,
    nominal: StandardParameters,
    base: BaseReduction,
    states: States,
}

impl Arm {
    fn a460() -> Self {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("a bundled robot");
        let robot = parse_robot(entry.robot).expect("a bundled robot is valid");
        let nominal = parse_nominal(entry.nominal, &robot).expect("bundled parameters are valid").parameters;
        let base =
            reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0)).expect("a bundled robot has a base");
        let mut rng = Seed::new(1).stream("instructions", 0);
        let mut states = States::new(6);
        for _ in 0..STATES {
            let (q, qd, qdd) = chains::random_state(&mut rng, 6);
            states.push(&q, &qd, &qdd);
        }
        Self { robot, nominal, base, states }
    }

    /// Random states with torque of the nominal parameters and noise.
    fn samples(&self, count: usize) -> Samples {
        let mut rng = Seed::new(2).stream("instructions", 0);
        let (mut states, mut tau) = (States::new(6), vec![0.0; 6 * count]);
        let mut dynamics = Dynamics::new(&self.robot, &self.nominal);
        for tau in tau.chunks_exact_mut(6) {
            let (q, qd, qdd) = chains::random_state(&mut rng, 6);
            dynamics.inverse(&q, &qd, &qdd, tau);
            for tau in tau {
                *tau += rng.random_range(-1.0..1.0);
            }
            states.push(&q, &qd, &qdd);
        }
        Samples::exact(states, tau, vec!["N·m".to_owned(); 6], 100.0)
    }
}

/// One evaluation at each state.
fn equations<'a>(arm: &'a Arm) -> Vec<Piece<'a>> {
    let states = &arm.states;
    let regressor = JointTorqueRegressor::new(&arm.robot, Columns::RIGID).expect("columns of motion");
    let lanes = regressor.clone();
    let mut y = vec![0.0; 360];
    let mut dynamics = Dynamics::new(&arm.robot, &arm.nominal);
    let (mut forward, mut out) = (dynamics.clone(), [0.0; 6]);
    vec![
        Piece::new("regressor", "evaluation", STATES, move || {
            for k in 0..STATES {
                regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
                black_box(&y);
            }
        }),
        Piece::new("regressor in lanes", "sample", STATES, move || {
            lanes.stack_in_parts(states, &arm.base.kept, 1, |part| {
                black_box(part.entries(0, 0));
            });
        }),
        Piece::new("inverse dynamics", "evaluation", STATES, move || {
            for k in 0..STATES {
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut out);
                black_box(&out);
            }
        }),
        Piece::new("forward dynamics", "evaluation", STATES, move || {
            for k in 0..STATES {
                forward.forward(states.q(k), states.qd(k), states.qdd(k), &mut out);
                black_box(&out);
            }
        }),
    ]
}

/// A simulated experiment with the robot's servo and sensors, alone and in lanes.
fn experiments<'a>(arm: &Arm, plan: &'a ExperimentPlan) -> Vec<Piece<'a>> {
    const RUNS: usize = 8;
    let text = truth_text("crs-a460").expect("a bundled robot");
    let truth = parse_parameters(text, &arm.robot, true).expect("bundled parameters are valid").parameters;
    let plant = AnalyticPlant::new(&arm.robot, &truth).expect("six joints");
    let servo = Servo::new(&arm.robot, &arm.nominal, plant).expect("the nominal arm has inertia");
    let mut alone = servo.clone().with_seed(Seed::new(1), 0);
    let steps = record(&mut alone, plan).expect("a plan that can be performed").0.len();
    vec![
        Piece::new("experiment", "step", steps, move || {
            alone = alone.clone().with_seed(Seed::new(1), 0);
            black_box(record(&mut alone, plan).expect("a plan that can be performed"));
        }),
        Piece::new("experiments in lanes", "step", RUNS * steps, move || {
            let runs: Vec<BatchRun<'_>> =
                (0..RUNS as u64).map(|run| BatchRun { plan, noise: Seed::new(1).of_run(run) }).collect();
            black_box(record_runs(&servo, &runs));
        }),
    ]
}

/// What is done once for a robot or a recording.
fn whole<'a>(arm: &'a Arm, samples: &'a Samples, chain: &'a Robot) -> Vec<Piece<'a>> {
    let identification = Identification::new(&arm.robot, Columns::RIGID).expect("a bundled robot has a base");
    let mut problem =
        DesignProblem::new(arm.robot.clone(), Columns::RIGID, CriterionKind::Condition, DesignLimits::motion())
            .expect("it has a base");
    problem.set_budget(DesignBudget { evaluations: 40, ..DesignBudget::default() }).expect("not zero");
    vec![
        Piece::new("identification", "sample", samples.states.len(), move || {
            let estimators = [EstimatorKind::Ols.estimator(), EstimatorKind::Wls.estimator()];
            let estimates = identification.estimate_watched(samples, &estimators, &Unobserved);
            black_box(estimates.expect("random states excite all"));
        }),
        Piece::new("reduction", "robot", 1, || {
            for method in [Method::Structural, Method::Radkhah2007] {
                black_box(
                    reduce(chain, Columns::RIGID_ROTOR_FRICTION, method, Seed::new(1)).expect("a finite geometry"),
                );
            }
        }),
        Piece::new("excitation", "design", 1, move || {
            black_box(design(&problem, Seed::new(1), 0).expect("a problem that is possible"));
        }),
    ]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let arm = Arm::a460();
    let samples = arm.samples(2000);
    let (chain, _) = chains::random_robot(&mut Seed::new(1).stream("instructions", 1), 8);
    let plan = ExperimentPlan::new(FourierTrajectory { period_s: 5.0, ..table_one::corrected() }).with_periods(1);
    let pieces = equations(&arm).into_iter().chain(experiments(&arm, &plan)).chain(whole(&arm, &samples, &chain));
    match arguments.first() {
        None => pieces.for_each(time),
        Some(name) => {
            let times: usize = arguments.get(1).and_then(|times| times.parse().ok()).expect("a number after the name");
            let mut piece = pieces.into_iter().find(|piece| piece.name == name).expect("the name of a piece of work");
            for _ in 0..times {
                (piece.run)();
            }
        }
    }
}

/// The best of some repeats that fill half a second.
fn time(mut piece: Piece<'_>) {
    let (began, mut best) = (Instant::now(), f64::INFINITY);
    while began.elapsed().as_secs_f64() < 0.5 {
        let once = Instant::now();
        (piece.run)();
        best = best.min(once.elapsed().as_secs_f64());
    }
    println!("{}\t{}\t{}\t{:.1}", piece.name, piece.unit, piece.of, best * 1e9 / piece.of as f64);
}
