//! The arms that can perform an experiment, and how one is asked to.

mod experiment;
#[cfg(debug_assertions)]
mod failing;
mod kind;
mod performance;
pub(crate) mod resumption;
pub(crate) mod speed;

pub(crate) use experiment::Experiment;
#[cfg(debug_assertions)]
pub(crate) use failing::Failing;
pub(crate) use kind::ArmKind;
pub(crate) use performance::{Performed, perform};
pub(crate) use speed::Speed;
