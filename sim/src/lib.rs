//! Plants: engines that turn joint torques into motion, behind `armid::experiment::Plant`.

mod analytic;

pub use analytic::{AnalyticError, AnalyticPlant, MOST_JOINTS};
