//! The commands, one file each.

mod command;
mod completions;
mod dynamics;
mod identify;
mod reduce;
mod robot;
mod run;
mod validate;

pub(crate) use command::{Command, carry_out};
