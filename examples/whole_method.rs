//! The whole method on a simulated arm: reduce, design, perform, identify, validate. On a real arm only the line of the
//! `Servo` is another one: anything that implements `Arm` takes its place, and a log file goes through `armid_io::Log`.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::estimation::{EstimatorKind, Identification};
use armid::excitation::{CriterionKind, DesignProblem, design};
use armid::experiment::{ExperimentPlan, Servo, record};
use armid::model::Columns;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid_io::robot;
use armid_sim::Engine;

fn main() -> Result<(), Box<dyn Error>> {
    let loaded = robot::named("planar-2r")?;
    let (arm, nominal) = (&loaded.robot, loaded.nominal.as_ref().expect("bundled robots have a nominal file"));
    let columns = Columns::RIGID_ROTOR_FRICTION;

    // Reduce: the parameters that torque reveals.
    let identification = Identification::new(arm, columns)?.with_nominal(nominal);
    // Design: two trajectories inside the robot's limits, one to identify by and one to validate by.
    let problem = DesignProblem::new(arm.clone(), columns, CriterionKind::DOptimal)?;
    let (excitation, other) = (design(&problem, Seed::new(1), 0)?, design(&problem, Seed::new(2), 0)?);
    // Perform: any `Arm` records its samples.
    let plant = Engine::Analytic.plant(arm, &loaded.truth()?.parameters)?;
    let mut servo = Servo::new(arm, nominal, plant)?.with_seed(Seed::new(1), 0);
    let (recording, _) = record(&mut servo, &ExperimentPlan::new(excitation.trajectory))?;
    let (unseen, _) = record(&mut servo, &ExperimentPlan::new(other.trajectory))?;
    // Identify, and validate on the trajectory that the estimate was not made from.
    let samples = process(&recording, arm, &Processing::default())?;
    let estimate = identification.estimate(&samples, EstimatorKind::Wls.estimator())?;
    let validation = identification.validate(&estimate, &process(&unseen, arm, &Processing::default())?)?;

    for parameter in &estimate.base {
        println!("{:10} {:10.5} ± {:.5} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
    }
    println!("torque prediction error, relative RMS per joint: {:?}", validation.relative_rms);
    if validation.is_within(0.05) { Ok(()) } else { Err("the estimate should predict torque within 5 %".into()) }
}
