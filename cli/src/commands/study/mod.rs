//! `armid study`: performed here, in parts, or by a cluster.

mod answer;
mod command;
mod merge;
mod overrides;
mod plan;
mod request;
mod submit;

pub(crate) use command::{Arguments, run};
