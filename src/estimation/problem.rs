//! Everything an estimator may look at.

use super::Observation;
use crate::model::{Robot, StandardParameters};
use crate::signal::Samples;

/// The equations, and what else is known; estimators that iterate, simulate or regularise need more than the equations.
///
/// ```
/// # use armid::estimation::{EstimationProblem, Observation};
/// # fn look(observation: &Observation) {
/// let problem = EstimationProblem::new(observation);
/// assert!(problem.nominal.is_none());
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct EstimationProblem<'a> {
    /// The stacked linear equations.
    pub observation: &'a Observation,
    /// The robot.
    pub robot: Option<&'a Robot>,
    /// The samples that the equations were made from.
    pub samples: Option<&'a Samples>,
    /// What an experimenter would have guessed.
    pub nominal: Option<&'a StandardParameters>,
}

impl<'a> EstimationProblem<'a> {
    /// The equations alone.
    #[must_use]
    pub const fn new(observation: &'a Observation) -> Self {
        Self { observation, robot: None, samples: None, nominal: None }
    }

    /// With the robot.
    #[must_use]
    pub const fn with_robot(mut self, robot: &'a Robot) -> Self {
        self.robot = Some(robot);
        self
    }

    /// With the samples.
    #[must_use]
    pub const fn with_samples(mut self, samples: &'a Samples) -> Self {
        self.samples = Some(samples);
        self
    }

    /// With a nominal set; estimates then carry a full set of standard parameters, see [`super::complete`].
    #[must_use]
    pub const fn with_nominal(mut self, nominal: &'a StandardParameters) -> Self {
        self.nominal = Some(nominal);
        self
    }
}
