//! The `armid` command: arguments, messages and composition. Files are read and written by `armid-io`; everything that is
//! computed, the library computes.

use crate::commands::CommandLine;
use crate::terminal::{Console, Ending};

mod answers;
mod arguments;
mod arms;
mod commands;
mod interrupt;
mod memory;
mod monitor;
mod terminal;

use std::process::ExitCode;

use armid_io::{Error, ErrorKind};
use clap::Parser;

/// Everything between the arguments of the process and its exit status.
pub fn main() -> ExitCode {
    memory::keep_freed();
    terminal::install_reporter();
    armid::remedy::set_wording(&terminal::Flags);
    let line = CommandLine::parse();
    let console = Console::new(line.global);
    let next_step = line.command.next_step();
    let outcome = interrupt::watch().and_then(|()| commands::carry_out(line.command, &console));
    match outcome {
        Ok(ending) => ending.exit_code(),
        Err(report)
            if report.is::<interrupt::Interrupted>()
                || report.downcast_ref::<Error>().is_some_and(|error| error.kind() == ErrorKind::Interrupted) =>
        {
            console.alarm(&report.to_string());
            Ending::Interrupted.exit_code()
        }
        Err(report) => {
            console.fault(&report, next_step);
            ExitCode::from(2)
        }
    }
}
