//! `armid completions`

use armid_io::output;
use clap::CommandFactory;
use clap_complete::Shell;
use miette::Result;

use crate::terminal::{Console, Ending};

const AFTER_HELP: &str = "\
Example:
  armid completions bash > ~/.local/share/bash-completion/completions/armid";

/// Print the completions for a shell
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::commands::CommandLine::command(), "armid", &mut script);
    let script = String::from_utf8_lossy(&script);
    match console.output() {
        Some(path) => output::write_text(path, &script)?,
        None => console.print(&script)?,
    }
    Ok(Ending::Done)
}
