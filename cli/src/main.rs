//! The `armid` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    armid_cli::main()
}
