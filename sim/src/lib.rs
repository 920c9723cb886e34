//! Plants: engines that turn joint torques into motion, behind `armid::experiment::Plant`.

mod analytic;

pub use analytic::{AnalyticError, AnalyticPlant, AnalyticTeam, MOST_JOINTS, perform_runs, record_runs};
