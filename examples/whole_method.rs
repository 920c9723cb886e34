//! The whole method on a simulated arm: design, perform, identify, validate. On a real arm only `simulate` is another function:
//! anything that implements `Arm` takes its place, and a log file goes through `armid_io::Log`.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::estimation::EstimatorKind;
use armid::excitation::CriterionKind;
use armid::experiment::ExperimentPlan;
use armid::model::Columns;
use armid::observer::Unobserved;
use armid_io::{LogSettings, robot};
use armid_workflow::design::{DesignGoal, DesignSettings, design};
use armid_workflow::{SimulationSettings, simulate};

fn main() -> Result<(), Box<dyn Error>> {
    let loaded = robot::named("planar-2r")?;
    // Two trajectories inside all limits of the robot, and what the arm does along each.
    let logs = [1, 2].map(|seed| {
        let goal = DesignGoal::Arm(CriterionKind::DOptimal);
        let settings = DesignSettings { seed, starts: 1, ..DesignSettings::new(goal) };
        let designed = design(&loaded, &settings, &Unobserved)?.ok_or("nobody ended the search")?;
        let plan = ExperimentPlan::new(designed.best.trajectory);
        let log = simulate(&loaded, &plan, &SimulationSettings::default(), &Unobserved)?.log();
        Ok::<_, Box<dyn Error>>(log.process(loaded.clone(), &LogSettings::default())?)
    });
    let [first, unseen] = logs;
    // Identify with one, and validate on the other.
    let estimate = first?.identify(Columns::RIGID_ROTOR_FRICTION, EstimatorKind::Wls)?;
    let validation = unseen?.validate(&estimate, "the estimate")?;

    for parameter in &estimate.base {
        println!("{:10} {:10.5} ± {:.5} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
    }
    println!("torque prediction error, relative RMS per joint: {:?}", validation.relative_rms);
    if validation.is_within(0.05) { Ok(()) } else { Err("the estimate should predict torque within 5 %".into()) }
}
