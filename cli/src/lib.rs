//! The `armid` command: arguments, files and composition. Everything it computes, the library computes.
//!
//! A library, so that the fuzz targets reach its decoders; the binary is one call of [`main`].

mod answer;
mod arguments;
mod arms;
mod atomic_file;
mod bundled_experiments;
mod choices;
mod commands;
mod comparison;
mod console;
pub mod decoders;
mod design_answer;
mod exchange;
mod fault;
mod files;
mod guarding;
mod identification;
mod interrupt;
mod limit_arguments;
mod monitor;
mod progress;
mod real_time;
mod resumption;
mod robot_source;
mod run_answer;
mod simulated_arm;
mod speed;
mod study_answer;
mod study_performance;
mod study_source;
mod suggestion;
mod table;

use std::process::ExitCode;

use clap::Parser;

use crate::arguments::Arguments;
use crate::console::Console;

/// Everything between the arguments of the process and its exit status.
#[must_use]
pub fn main() -> ExitCode {
    fault::install_reporter();
    let arguments = Arguments::parse();
    let console = Console::new(arguments.global);
    let outcome = interrupt::watch().and_then(|()| commands::carry_out(arguments.command, &console));
    match outcome {
        Ok(ending) => ending.exit_code(),
        Err(report) => {
            console.fault(&report);
            ExitCode::from(2)
        }
    }
}
