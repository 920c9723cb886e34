//! How long the estimators that simulate take: 10 s of Table I at 1 kHz on the A460, all 58 parameters, one core.
//!
//! `cargo bench -p armid-sim --bench closed_loop` prints seconds and what the estimate is worth.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use std::time::Instant;

use armid::base::{Method, reduce};
use armid::estimation::{EstimationProblem, EstimatorKind, Observation, closed_loop_of};
use armid::experiment::{ExperimentPlan, Servo, record};
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::{Columns, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid_sim::{AnalyticPlant, closed_loop};

fn main() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("the A460 is bundled");
    let robot = parse_robot(entry.robot).expect("a valid robot");
    let nominal = parse_nominal(entry.nominal, &robot).expect("valid parameters").parameters;
    let truth = parse_parameters(truth_text(entry.name).expect("bundled"), &robot, true).expect("valid").parameters;
    let plant = AnalyticPlant::new(&robot, &truth).expect("six joints");
    let mut servo = Servo::new(&robot, &nominal, plant).expect("a servo").with_seed(Seed::new(1), 0);
    let plan = ExperimentPlan::new(table_one::corrected()).with_periods(10);
    let recording = record(&mut servo, &plan).expect("an experiment").0;
    let samples = process(&recording, &robot, &Processing::default()).expect("samples");

    let columns = Columns::RIGID_ROTOR_FRICTION;
    let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
    let base = reduce(&robot, columns, Method::Structural, Seed::new(1)).expect("a reduction");
    let beta = base.beta(&truth.vector(&robot, columns));
    let observation = Observation::new(&robot, &regressor, &base, &samples).expect("equations");
    for kind in [EstimatorKind::Wls, EstimatorKind::Iv, EstimatorKind::Didim, EstimatorKind::Clie, EstimatorKind::Cloe]
    {
        let begin = Instant::now();
        let known = closed_loop_of(Some(closed_loop), &robot, Some(&nominal), &[Some(&recording)]).expect("a loop");
        let problem = EstimationProblem {
            robot: Some(&robot),
            samples: Some(&samples),
            nominal: Some(&nominal),
            closed_loop: Ok(&*known),
            ..EstimationProblem::new(&observation)
        };
        let found = kind.estimator().estimate(&problem).expect("an estimate");
        let seconds = begin.elapsed().as_secs_f64();
        let error = (found.beta() - &beta).norm() / beta.norm();
        let held = found.base.iter().zip(&beta).filter(|(p, x)| p.ci95[0] <= **x && **x <= p.ci95[1]).count();
        println!(
            "{}: {seconds:.2} s, {}, relative error {error:.1e}, {held} of {} intervals hold the truth",
            kind.name(),
            found.termination,
            beta.len()
        );
    }
}
