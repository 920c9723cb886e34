//! Everything an estimator may look at.

use std::borrow::Cow;

use super::closed_loop::{ClosedLoop, ClosedLoopError};
use super::error::EstimationError;
use super::factorisation::Factorisation;
use super::observation::Observation;
use super::termination::Termination;
use crate::model::{Robot, StandardParameters};
use crate::observer::{Observer, Progress, Unobserved, Work};
use crate::signal::Samples;

/// The equations, and what else is known.
///
/// Linear estimators need the equations alone, by [`EstimationProblem::factorised`]. One that simulates the arm (direct and inverse identification, say) or makes
/// instruments from simulated states needs its closed loop, the robot and the samples; one that corrects the states, or differentiates them again, needs the
/// samples; one that regularises needs the nominal set. [`EstimationProblem::robot_for`] and its like give what is there, or
/// the error that names what is missing.
///
/// ```
/// # use armid_estimation as armid;
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
    /// What an experimenter would have guessed; estimates then carry a full set of standard parameters, see [`super::complete`].
    pub nominal: Option<&'a StandardParameters>,
    /// Where estimators that simulate the arm begin, in place of the weighted linear fit; no other begins anywhere but with the
    /// equations.
    pub start: Option<&'a StandardParameters>,
    /// The arm under its known servo along the motion of the samples, or what is not known of it.
    pub closed_loop: Result<&'a dyn ClosedLoop, &'a ClosedLoopError>,
    /// The factorisation of the equations, which several estimators may share.
    pub factorisation: Option<&'a Factorisation<'a>>,
    /// Who watches an estimator that iterates, and may end it.
    pub observer: &'a dyn Observer,
}

impl<'a> EstimationProblem<'a> {
    /// The equations alone.
    pub const fn new(observation: &'a Observation) -> Self {
        let closed_loop = Err(&ClosedLoopError::NotGiven);
        Self {
            observation,
            robot: None,
            samples: None,
            nominal: None,
            start: None,
            closed_loop,
            factorisation: None,
            observer: &Unobserved,
        }
    }

    /// Reports the steps of an iteration so far, of `total` at most. The termination of one that is to end here.
    pub fn ended_after(&self, iterations: usize, total: usize) -> Option<Termination> {
        let seen = self.observer.observe(Progress { work: Work::Steps, done: iterations, total });
        seen.is_break().then_some(Termination::Interrupted { iterations })
    }

    /// The factorisation of its equations: the one that it holds, where that is of this observation, or a new one.
    ///
    /// # Errors
    /// As [`Factorisation::new`].
    pub fn factorised(&self) -> Result<Cow<'a, Factorisation<'a>>, EstimationError> {
        match self.factorisation {
            Some(known) if std::ptr::eq(known.observation(), self.observation) => Ok(Cow::Borrowed(known)),
            _ => Factorisation::new(self.observation).map(Cow::Owned),
        }
    }

    /// The robot, for an estimator that cannot do without.
    ///
    /// # Errors
    /// [`EstimationError::Missing`] where the problem holds none.
    pub fn robot_for(&self, estimator: &str) -> Result<&'a Robot, EstimationError> {
        self.robot.ok_or(EstimationError::Missing { estimator: estimator.to_owned(), part: "the robot" })
    }

    /// The samples, for an estimator that cannot do without.
    ///
    /// # Errors
    /// [`EstimationError::Missing`] where the problem holds none.
    pub fn samples_for(&self, estimator: &str) -> Result<&'a Samples, EstimationError> {
        self.samples.ok_or(EstimationError::Missing { estimator: estimator.to_owned(), part: "the samples" })
    }

    /// The closed loop, for an estimator that cannot do without.
    ///
    /// # Errors
    /// [`EstimationError::ClosedLoop`] with what is not known of it.
    pub fn closed_loop_for(&self, estimator: &str) -> Result<&'a dyn ClosedLoop, EstimationError> {
        self.closed_loop
            .map_err(|reason| EstimationError::ClosedLoop { estimator: estimator.to_owned(), reason: reason.clone() })
    }

    /// The nominal set, for an estimator that cannot do without.
    ///
    /// # Errors
    /// [`EstimationError::Missing`] where the problem holds none.
    pub fn nominal_for(&self, estimator: &str) -> Result<&'a StandardParameters, EstimationError> {
        self.nominal
            .ok_or(EstimationError::Missing { estimator: estimator.to_owned(), part: "a nominal set of parameters" })
    }
}
