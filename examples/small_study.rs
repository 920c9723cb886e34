//! A small study: the same experiment many times with other noise, and how often the 95 % intervals hold the truth.
//! `armid study` does this for several designs, estimators and conditions, on all cores and with a report.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;

use armid::estimation::{EstimatorKind, Identification};
use armid::experiment::{Effects, ExperimentPlan, Sensing, record};
use armid::model::Columns;
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid_io::{robot, trajectory};
use armid_sim::Engine;
use armid_workflow::simulated_arm;

const RUNS: u64 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let loaded = robot::find("crs-a460")?;
    let (arm, nominal) = (&loaded.robot, loaded.nominal.as_ref().expect("bundled robots have a nominal file"));
    // What the simulated arm is made of. The estimator never sees it.
    let simulated = simulated_arm(&loaded, Engine::Analytic, Effects::none())?;
    let truth = &simulated.truth.parameters;
    let plan = ExperimentPlan::new(trajectory::load("table-one", None, arm)?);
    let identification = Identification::new(arm, Columns::RIGID_ROTOR_FRICTION)?.with_nominal(nominal);
    let exact = identification.base().beta(&truth.vector(arm, Columns::RIGID_ROTOR_FRICTION));

    for kind in [EstimatorKind::Ols, EstimatorKind::Wls] {
        let (mut held, mut intervals) = (0, 0);
        for run in 0..RUNS {
            let mut servo = simulated.servo(&Sensing::default())?.with_seed(Seed::new(1), run);
            let samples = process(&record(&mut servo, &plan)?.0, arm, &Processing::default())?;
            let estimate = identification.estimate(&samples, kind.estimator())?;
            intervals += estimate.base.len();
            held += estimate
                .base
                .iter()
                .zip(exact.iter())
                .filter(|(found, exact)| (found.ci95[0]..=found.ci95[1]).contains(*exact))
                .count();
        }
        let share = 100.0 * held as f64 / intervals as f64;
        println!("{}: {share:.1} % of {intervals} intervals hold the truth, 95 % is right", kind.name());
        if !(85.0..100.0).contains(&share) {
            return Err("intervals should hold the truth about as often as they say".into());
        }
    }
    Ok(())
}
