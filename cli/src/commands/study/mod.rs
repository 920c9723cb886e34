//! `armid study`: whole or in parts.

mod answer;
mod command;
mod merge;
mod overrides;
mod plan;
mod request;

pub(crate) use command::{Arguments, run};
