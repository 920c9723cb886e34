//! `armid study`: performed here, in parts, or by a cluster.

mod cancel;
mod collect;
mod command;
mod merge;
mod overrides;
mod plan;
mod status;
mod submit;

pub(crate) use command::{Arguments, run};
