//! The arms that can perform an experiment, and how one is asked to.

mod experiment;
mod kind;
mod performance;
pub(crate) mod resumption;
mod simulation;
pub(crate) mod speed;

pub(crate) use experiment::Experiment;
pub(crate) use kind::ArmKind;
pub(crate) use performance::{Performed, perform};
pub(crate) use simulation::Simulation;
pub(crate) use speed::Speed;
