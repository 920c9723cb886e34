//! The `armid` command: arguments, files and composition. Everything it computes, the library computes.

mod answer;
mod arguments;
mod arms;
mod atomic_file;
mod bundled_experiments;
mod choices;
mod commands;
mod console;
mod design_answer;
mod fault;
mod files;
mod identification;
mod interrupt;
mod limit_arguments;
mod progress;
mod robot_source;
mod simulated_arm;
mod study_answer;
mod study_performance;
mod study_source;
mod suggestion;
mod table;

use std::process::ExitCode;

use clap::Parser;

use crate::arguments::Arguments;
use crate::console::Console;

fn main() -> ExitCode {
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
