//! Plants: engines that turn joint torques into motion, behind `armid::experiment::Plant`, and how far they agree.
#![deny(unsafe_code)]

pub mod agreement;
mod analytic;
mod engine;
mod mujoco;
mod rapier;

pub use analytic::{AnalyticBatch, AnalyticError, AnalyticPlant, BatchRun, MOST_JOINTS, perform_runs, record_runs};
pub use engine::{Engine, EngineError};
pub use mujoco::{
    MujocoError, MujocoModel, MujocoPlant, MujocoScheme, MujocoStatus, MujocoStepper, mjcf, mjcf_for_exchange,
};
pub use rapier::{DEFAULT_SUBSTEPS, RapierError, RapierPlant};
