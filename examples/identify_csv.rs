//! Identify a robot from a CSV of positions and torques: `cargo run --bin identify-csv -- LOG.csv ROBOT PERIOD_S SKIP_S`.
//!
//! ROBOT is a bundled name or a file, as on the command line; the CSV has the headings `t,q1..qn,tau1..taun` or
//! `t,q1..qn,current1..currentn`.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;
use std::path::Path;

use armid::estimation::EstimatorKind;
use armid::model::Columns;
use armid_io::{Log, LogSettings, robot};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, name, period_s, skip_s] = arguments.as_slice() else {
        return Err("expected LOG.csv ROBOT PERIOD_S SKIP_S".into());
    };

    let settings = LogSettings { from_s: skip_s.parse()?, ..LogSettings::periodic(period_s.parse()?) };
    let processed = Log::read(Path::new(log))?.process(robot::find(name)?, &settings)?;
    let estimate = processed.identify(Columns::RIGID_ROTOR_FRICTION, EstimatorKind::Wls)?;

    for parameter in &estimate.base {
        println!("{:40} {:12.6} ± {:.6} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
    }
    for finding in &estimate.findings {
        println!("{finding}\n  → {}", finding.advice());
    }
    Ok(())
}
