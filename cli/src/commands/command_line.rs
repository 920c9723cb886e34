//! What the command line looks like.

use super::Command;
use crate::terminal::GlobalArguments;

const AFTER_HELP: &str = "\
Exit status: 0 done; 1 the work ran and its verdict is negative; 2 bad input or usage;
130 interrupted, with what was finished kept.
Everything is in SI units and radians unless a name ends in another unit (_deg).

ROBOT is a bundled name (`armid robot` lists them), a path to a robot.toml, or a .urdf or
MJCF .xml file.

From a robot to an estimate and a check of it:
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
