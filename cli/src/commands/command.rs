//! The list of commands.

use miette::Result;

use super::{
    advise, agree, calibrate, campaign, completions, controller, design, doctor, dynamics, export, identify, init,
    monitor, reduce, report, robot, run, study, topic, trajectory, validate,
};
use crate::terminal::{Console, Ending, Writes};

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Command {
    Robot(robot::Arguments),
    Init(init::Arguments),
    Advise(advise::Arguments),
    Campaign(campaign::Arguments),
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

/// Does it, with `-o` as what the command writes.
pub(crate) fn carry_out(command: Command, console: &Console) -> Result<Ending> {
    let on = |writes: Writes| console.writing(writes);
    match command {
        Command::Advise(arguments) => advise::run(&arguments, &on(Writes::Folder)?),
        Command::Campaign(arguments) => campaign::run(&arguments, &on(Writes::Folder)?),
        Command::Agree(arguments) => agree::run(&arguments, &on(Writes::Folder)?),
        Command::Robot(arguments) => robot::run(&arguments, &on(Writes::Answer)?),
        Command::Init(arguments) => init::run(&arguments, &on(Writes::Folder)?),
        Command::Reduce(arguments) => reduce::run(&arguments, &on(Writes::Answer)?),
        Command::Dynamics(arguments) => dynamics::run(&arguments, &on(Writes::Answer)?),
        Command::Design(arguments) => design::run(&arguments, &on(Writes::Text)?),
        Command::Trajectory(arguments) => trajectory::run(&arguments, &on(Writes::Text)?),
        Command::Calibrate(arguments) => calibrate::run(&arguments, &on(Writes::Several)?),
        Command::Run(arguments) => run::run(&arguments, &on(Writes::Recording)?),
        Command::Monitor(arguments) => monitor::run(&arguments, &on(Writes::Answer)?),
        Command::Identify(arguments) => identify::run(&arguments, &on(Writes::Answer)?),
        Command::Validate(arguments) => validate::run(&arguments, &on(Writes::Answer)?),
        Command::Export(arguments) => export::run(&arguments, &on(Writes::Text)?),
        Command::Study(arguments) => study::run(&arguments, &on(Writes::Folder)?),
        Command::Report(arguments) => report::run(&arguments, &on(Writes::Folder)?),
        Command::Controller(arguments) => controller::run(&arguments, &on(Writes::Answer)?),
        Command::Doctor(arguments) => doctor::run(&arguments, &on(Writes::Answer)?),
        Command::Completions(arguments) => completions::run(&arguments, &on(Writes::Answer)?),
        Command::Topic(topic) => topic::run(&topic, &on(Writes::Answer)?),
    }
}
