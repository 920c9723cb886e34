//! What the command line looks like.

use super::Command;
use crate::terminal::GlobalArguments;

const AFTER_HELP: &str = "\
Exit status: 0 done; 1 negative verdict; 2 bad input or usage; 130 interrupted, finished work is kept. \
Units are SI and radians unless a name says otherwise (_deg).

ROBOT is a bundled name (`armid robot`), a robot.toml, a URDF or an MJCF. More help: `armid help map` (columns of a log), \
`armid help limits` (of a design).

Examples:
  armid design crs-a460 --criterion d-optimal -o T.toml
  armid run experiment.toml -o R.mcap
  armid identify R.mcap -o E.json
  armid validate E.json other.mcap";

/// Identifies the dynamic parameters of robot arms, and shows by simulation which design and estimator to trust.
#[derive(Debug, clap::Parser)]
#[command(name = "armid", version, after_help = AFTER_HELP, max_term_width = 100)]
#[command(subcommand_required = true, arg_required_else_help = true, propagate_version = true)]
pub(crate) struct CommandLine {
    #[command(flatten)]
    pub(crate) global: GlobalArguments,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory};

    use super::CommandLine;

    fn all(command: Command) -> Vec<Command> {
        let below = command.get_subcommands().cloned().flat_map(all).collect::<Vec<_>>();
        std::iter::once(command).chain(below).collect()
    }

    #[test]
    fn help_is_short_and_is_wrapped_by_the_terminal_alone() {
        for command in all(CommandLine::command()) {
            let name = command.get_name();
            let help = command.get_arguments().filter_map(|option| option.get_help().map(ToString::to_string));
            let long: Vec<String> = help.filter(|help| help.split_whitespace().count() > 12).collect();
            assert!(long.is_empty(), "{name}: {long:?}");
            let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let lines: Vec<&str> = after.lines().collect();
            for pair in lines.windows(2) {
                let is_prose = |line: &str| !line.is_empty() && !line.starts_with(' ');
                assert!(!(is_prose(pair[0]) && is_prose(pair[1])), "{name}: a paragraph has a line break: {pair:?}");
            }
            let prose =
                lines.iter().take_while(|line| !line.starts_with("Example")).filter(|line| !line.starts_with(' '));
            let words = prose.flat_map(|line| line.split_whitespace()).count();
            assert!(words <= 60, "{name}: {words} words above the examples: {after}");
        }
    }
}
