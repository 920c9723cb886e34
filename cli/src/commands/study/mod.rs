//! `armid study`: performed here, in parts, or by a cluster.

mod answer;
mod cancel;
mod collect;
mod command;
mod dry_run;
mod merge;
mod overrides;
mod plan;
mod request;
mod status;
mod submit;

pub(crate) use command::{Arguments, run};
