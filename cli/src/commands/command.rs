//! The list of commands.

use miette::Result;

use super::{
    advise, agree, calibrate, completions, controller, design, doctor, dynamics, export, identify, init, monitor,
    reduce, report, robot, run, study, topic, trajectory, validate,
};
use crate::terminal::{Console, Ending, Writes};

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Command {
    Robot(robot::Arguments),
    Init(init::Arguments),
    Advise(advise::Arguments),
    Agree(agree::Arguments),
    Reduce(reduce::Arguments),
    Dynamics(dynamics::Arguments),
    Design(design::Arguments),
    Trajectory(trajectory::Arguments),
    Run(run::Arguments),
    Calibrate(calibrate::Arguments),
    Monitor(monitor::Arguments),
    Identify(identify::Arguments),
    Validate(validate::Arguments),
    Export(export::Arguments),
    Study(study::Arguments),
    Report(report::Arguments),
    Controller(controller::Arguments),
    Doctor(doctor::Arguments),
    Completions(completions::Arguments),
    #[command(flatten)]
    Topic(topic::Topic),
}

impl Command {
    /// What it writes, and so what `-o` may be.
    const fn writes(&self) -> Writes {
        match self {
            Self::Robot(_)
            | Self::Reduce(_)
            | Self::Dynamics(_)
            | Self::Monitor(_)
            | Self::Identify(_)
            | Self::Validate(_)
            | Self::Controller(_)
            | Self::Doctor(_)
            | Self::Completions(_)
            | Self::Topic(_) => Writes::Answer,
            Self::Design(_) | Self::Trajectory(_) | Self::Export(_) => Writes::Text,
            Self::Run(_) => Writes::Recording,
            Self::Calibrate(_) => Writes::Several,
            Self::Advise(_) | Self::Agree(_) | Self::Init(_) | Self::Study(_) | Self::Report(_) => Writes::Folder,
        }
    }
}

/// Does it.
pub(crate) fn carry_out(command: Command, console: &Console) -> Result<Ending> {
    let console = &console.writing(command.writes())?;
    match command {
        Command::Advise(arguments) => advise::run(&arguments, console),
        Command::Agree(arguments) => agree::run(&arguments, console),
        Command::Robot(arguments) => robot::run(&arguments, console),
        Command::Init(arguments) => init::run(&arguments, console),
        Command::Reduce(arguments) => reduce::run(&arguments, console),
        Command::Dynamics(arguments) => dynamics::run(&arguments, console),
        Command::Design(arguments) => design::run(&arguments, console),
        Command::Trajectory(arguments) => trajectory::run(&arguments, console),
        Command::Calibrate(arguments) => calibrate::run(&arguments, console),
        Command::Run(arguments) => run::run(&arguments, console),
        Command::Monitor(arguments) => monitor::run(&arguments, console),
        Command::Identify(arguments) => identify::run(&arguments, console),
        Command::Validate(arguments) => validate::run(&arguments, console),
        Command::Export(arguments) => export::run(&arguments, console),
        Command::Study(arguments) => study::run(&arguments, console),
        Command::Report(arguments) => report::run(&arguments, console),
        Command::Controller(arguments) => controller::run(&arguments, console),
        Command::Doctor(arguments) => doctor::run(&arguments, console),
        Command::Completions(arguments) => completions::run(&arguments, console),
        Command::Topic(topic) => topic::run(&topic, console),
    }
}
