//! What is asked of engines.

use armid::experiment::ExperimentPlan;
use armid::model::{Robot, StandardParameters};
use armid::seed::Seed;

/// What engines are asked to agree on.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// What its servo is tuned for.
    pub nominal: &'a StandardParameters,
    /// What the plants are made of.
    pub truth: &'a StandardParameters,
    /// The experiment of the closed loop; one period is recorded.
    pub plan: &'a ExperimentPlan,
    /// Where random states come from.
    pub seed: Seed,
}
