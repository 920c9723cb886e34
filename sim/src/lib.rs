//! Plants: engines that turn joint torques into motion, behind `armid::experiment::Plant`.
#![deny(unsafe_code)]

mod analytic;
mod mujoco;
mod rapier;

pub use analytic::{AnalyticError, AnalyticPlant, AnalyticTeam, MOST_JOINTS, perform_runs, record_runs};
pub use mujoco::{MujocoError, MujocoModel, MujocoPlant, MujocoScheme, MujocoStatus, MujocoStepper, mjcf};
pub use rapier::{DEFAULT_SUBSTEPS, RapierError, RapierPlant};
