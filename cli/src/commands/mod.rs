//! The commands, one file each.

mod command;
mod completions;
mod robot;

pub(crate) use command::{Command, run};
