//! The commands, one file each.

mod advise;
mod agree;
mod calibrate;
mod campaign;
mod command;
mod command_line;
mod completions;
mod controller;
mod design;
mod doctor;
mod drive_gains;
mod dynamics;
mod export;
mod identify;
mod init;
mod monitor;
mod next_step;
mod payload;
mod reduce;
mod report;
mod robot;
mod run;
mod validate;
mod study;
mod topic;
mod trajectory;

pub(crate) use command::{Command, carry_out};
pub(crate) use command_line::CommandLine;
