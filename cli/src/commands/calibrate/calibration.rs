//! The calibrations, as subcommands.

use miette::Result;

use super::{friction, payload, torque_constant};
use crate::terminal::{Console, Ending};

const AFTER_HELP: &str = "\
torque-constant and friction move one joint there and back at several constant speeds, and write motion, \
experiment, recording, result and figure. On a real arm take three steps: --plan-only writes the experiment, \
`armid run` performs it under its guard, --recording evaluates it.

Examples:
  armid calibrate torque-constant crs-a460 --joint shoulder -o bench/shoulder.json
  armid calibrate friction crs-a460 --joint 2 --recording bench/shoulder.mcap
  armid calibrate payload crs-a460 --mass-kg 1 --centre-m 0,0,0.05 --trajectory table-one";

/// Measure torque constants and friction, joint by joint
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    calibration: Calibration,
}

#[derive(Debug, clap::Subcommand)]
enum Calibration {
    TorqueConstant(torque_constant::Arguments),
    Friction(friction::Arguments),
    Payload(payload::Arguments),
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    match &arguments.calibration {
        Calibration::TorqueConstant(arguments) => torque_constant::run(arguments, console),
        Calibration::Friction(arguments) => friction::run(arguments, console),
        Calibration::Payload(arguments) => payload::run(arguments, console),
    }
}
