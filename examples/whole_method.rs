//! The whole method on a simulated arm: design, perform, identify, validate. On a real arm only `simulate` is another function:
//! anything that implements `Arm` takes its place, and a log file goes through `armid_io::Log`.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::excitation::CriterionKind;
use armid::experiment::ExperimentPlan;
use armid::observer::Unobserved;
use armid_io::{LogSettings, robot};
use armid_workflow::design::{DesignGoal, DesignSettings, design};
use armid_workflow::identification::{IdentifySettings, identify};
use armid_workflow::{SimulationSettings, simulate, validate};

fn main() -> Result<(), Box<dyn Error>> {
    let loaded = robot::find("planar-2r")?;
    // What the arm does along a trajectory inside all limits of the robot.
    let measured = |seed| {
        let settings =
            DesignSettings { seed, starts: 1, ..DesignSettings::new(DesignGoal::Arm(CriterionKind::DOptimal.into())) };
        let designed = design(&loaded, &settings, &Unobserved)?.ok_or("nobody ended the search")?;
        let plan = ExperimentPlan::new(designed.best.trajectory);
        let log = simulate(&loaded, &plan, &SimulationSettings::default(), &Unobserved)?.log();
        Ok::<_, Box<dyn Error>>(log.process(loaded.clone(), &LogSettings::default())?)
    };
    // Identify with one log, and validate on another.
    let answer = identify(measured(1)?, None, &IdentifySettings::default(), &Unobserved)?;
    let found =
        validate(&[answer.estimates[0].estimate.clone()], "the estimate", &measured(2)?, [None; 2], 0.05, &Unobserved)?;
    println!("torque prediction error, relative RMS per joint: {:?}", found.verdicts[0].validation.relative_rms);
    if found.passed() { Ok(()) } else { Err("the estimate should predict torque within 5 %".into()) }
}
