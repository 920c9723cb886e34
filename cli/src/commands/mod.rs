//! The commands, one file each.

mod command;
mod completions;
mod dynamics;
mod reduce;
mod robot;

pub(crate) use command::{Command, run};
