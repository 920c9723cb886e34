//! The method in one value: what is estimated of which robot, ready for the samples of any experiment.
//!
//! ```text
//! robot, columns → Y, K        samples → W_b, y        W_b β = y + ε → β̂, cov β̂
//! ```

use std::sync::Arc;

use nalgebra::DVector;

use super::closed_loop::{ClosedLoop, ClosedLoopError};
use super::error::EstimationError;
use super::estimate::Estimate;
use super::estimator::Estimator;
use super::factorisation::Factorisation;
use super::finding::Finding;
use super::friction_speed::FrictionSpeeds;
use super::linear_fit::LinearFit;
use super::load_fit::observe;
use super::observation::LEAST_SHARE;
use super::observation::Observation;
use super::omitted::omitted_torque;
use super::prediction::{Validation, validate};
use super::problem::EstimationProblem;
use super::termination::Termination;
use super::{load_fit, load_friction};
use crate::base::{BaseReduction, Method, reduce};
use crate::dynamics::States;
use crate::model::term::ShapeParameter;
use crate::model::{Columns, Robot, StandardParameters};
use crate::observer::{Observer, Unobserved};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::Samples;
use crate::spatial::Inertia;

/// States from which it is decided what a motion reveals, at most.
const MOTION_STATES: usize = 500;

/// The estimate, where its log has no noise, with one finding that says so in place of those that compare with noise.
fn without_noise_that_is_not(mut estimate: Estimate, samples: &Samples) -> Estimate {
    if estimate.findings.iter().any(Finding::compares_with_noise) && samples.is_noise_free() {
        estimate.findings.retain(|finding| !finding.compares_with_noise());
        estimate.findings.push(Finding::NoNoise);
    }
    estimate
}

/// Regressor and base parameters of a robot, which every experiment on it shares.
///
/// ```
/// # use armid_estimation as armid;
/// use armid::chains;
/// use armid::dynamics::{Dynamics, States};
/// use armid::estimation::{EstimatorKind, Identification};
/// use armid::model::{Columns, DriveParameters, StandardParameters};
/// use armid::seed::Seed;
/// use armid::signal::Samples;
/// let mut rng = Seed::new(1).stream("example", 0);
/// let (robot, truth) = chains::random_robot(&mut rng, 3);
/// // Random states, and the torque that gives them.
/// let (mut states, mut tau) = (States::new(3), Vec::new());
/// for _ in 0..200 {
///     let (q, qd, qdd) = chains::random_state(&mut rng, 3);
///     let mut one = [0.0; 3];
///     Dynamics::new(&robot, &truth).inverse(&q, &qd, &qdd, &mut one);
///     states.push(&q, &qd, &qdd);
///     tau.extend(one);
/// }
/// let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 3], 100.0);
///
/// let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION)?;
/// let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator())?;
/// let exact = identification.base().beta(&truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
/// assert!((estimate.beta() - exact).amax() < 1e-6);
/// # Ok::<(), armid::estimation::EstimationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Identification {
    robot: Robot,
    nominal: Option<StandardParameters>,
    /// The parameters that estimators which simulate the arm begin with, in place of the weighted linear fit.
    pub start: Option<StandardParameters>,
    /// The closed loop in which the samples were recorded, or what is not known of it, for estimators that simulate.
    pub closed_loop: Result<Arc<dyn ClosedLoop>, ClosedLoopError>,
    regressor: JointTorqueRegressor,
    base: BaseReduction,
    /// Tests the laws that drives have and the model omits: friction of the load, current lag, elasticity and presliding. Intervals include
    /// what the log cannot exclude of them, and a [`Finding::EffectShown`] names each that it supports.
    pub tests_laws: bool,
}

impl Identification {
    /// What is estimated: the base of these columns, by the structural reduction.
    ///
    /// # Errors
    /// [`EstimationError::Base`] where the robot's geometry is not finite, [`EstimationError::Columns`] where a term depends on what no
    /// recording has.
    pub fn new(robot: &Robot, columns: Columns) -> Result<Self, EstimationError> {
        // The structural reduction draws nothing: any seed gives the same.
        let base = reduce(robot, columns, Method::Structural, Seed::new(0))?;
        Ok(Self::of(robot, load_friction::regressor_of(robot, columns)?, base))
    }

    /// What is estimated where a motion does not show every parameter, a joint stands still, say: the base that the equations of
    /// these samples reveal, at most 500 states of them, by QR. Rows that are no equations count for nothing.
    ///
    /// # Errors
    /// [`EstimationError::Columns`] as above.
    ///
    /// # Panics
    /// If the samples are of another robot.
    pub fn on_motion(robot: &Robot, columns: Columns, samples: &Samples) -> Result<Self, EstimationError> {
        let (states, n) = (&samples.states, samples.dof());
        let places = (0..states.len()).step_by(states.len().div_ceil(MOTION_STATES).max(1));
        let mut few = States::new(n);
        for k in places.clone() {
            few.push(states.q(k), states.qd(k), states.qdd(k));
        }
        let regressor = load_friction::regressor_of(robot, columns)?;
        // Which columns there are does not depend on how large the load is.
        let mut w = regressor.with_links(&vec![1.0; 10 * n]).stack(&few);
        // What is no equation reveals nothing, and neither does a trace of a column of which all but that is in such rows.
        let mut left_out = vec![0.0_f64; w.ncols()];
        for (row, (k, i)) in places.flat_map(|k| (0..n).map(move |i| (k, i))).enumerate() {
            if !samples.used.get(k / samples.block * n + i).is_some_and(|used| *used) {
                for (largest, entry) in left_out.iter_mut().zip(w.row_mut(row).iter_mut()) {
                    *largest = largest.max(std::mem::take(entry).abs());
                }
            }
        }
        for (mut column, left_out) in w.column_iter_mut().zip(left_out) {
            if column.amax() < LEAST_SHARE * left_out {
                column.fill(0.0);
            }
        }
        let base = BaseReduction::from_stack(regressor.parameters(), &w, Method::Qr);
        Ok(Self::of(robot, regressor, base))
    }

    fn of(robot: &Robot, regressor: JointTorqueRegressor, base: BaseReduction) -> Self {
        Self {
            robot: robot.clone(),
            nominal: None,
            start: None,
            closed_loop: Err(ClosedLoopError::NotGiven),
            regressor,
            base,
            tests_laws: false,
        }
    }

    /// Adds a nominal set. Estimates then carry a full set of standard parameters, see [`super::complete`].
    #[must_use]
    pub fn with_nominal(self, nominal: &StandardParameters) -> Self {
        Self { nominal: Some(nominal.clone()), ..self }
    }

    /// The base parameters.
    pub const fn base(&self) -> &BaseReduction {
        &self.base
    }

    const fn columns(&self) -> Columns {
        self.regressor.columns()
    }

    /// Estimates them from the samples of one experiment.
    ///
    /// # Errors
    /// [`EstimationError`] where the samples are of another robot or the equations have no answer.
    pub fn estimate(&self, samples: &Samples, estimator: &dyn Estimator) -> Result<Estimate, EstimationError> {
        let mut estimates = self.estimate_watched(samples, &[estimator], &Unobserved)?;
        Ok(estimates.swap_remove(0))
    }

    /// Estimates them by several estimators, which share one factorisation of the equations, and reports to an observer. It may end estimators
    /// that iterate: the estimate is then the last iterate. One that simulates and was ended before its first iterate is the weighted linear fit, from which it begins.
    ///
    /// # Errors
    /// [`EstimationError`] of the first estimator that has no answer.
    pub fn estimate_watched(
        &self,
        samples: &Samples,
        estimators: &[&dyn Estimator],
        observer: &dyn Observer,
    ) -> Result<Vec<Estimate>, EstimationError> {
        let observation = self.observation(samples)?;
        let mut equations = Factorisation::new(&observation)?;
        if self.tests_laws {
            equations.omitted = omitted_torque(&self.robot, &equations, samples)?;
        }
        let problem = self.problem(&observation, samples);
        let problem = EstimationProblem { factorisation: Some(&equations), observer, ..problem };
        let estimated = |estimator: &&dyn Estimator| {
            let found = match estimator.estimate(&problem) {
                Err(EstimationError::Interrupted) => {
                    let linear = LinearFit::weighted(&equations)?;
                    linear.estimate(estimator.name(), &problem, &linear.fit, Termination::Interrupted { iterations: 0 })
                }
                found => found,
            };
            let mut estimate = without_noise_that_is_not(found?, samples);
            estimate.withhold_impossible(&self.base);
            Ok(estimate)
        };
        estimators.iter().map(estimated).collect()
    }

    /// The speeds of a kind that the laws of friction of the joints have, by variable projection; `None` where no column has one. An estimate
    /// with them is that of an identification of [`FrictionSpeeds::robot`]; its intervals take them as exact.
    ///
    /// # Errors
    /// As [`Self::estimate`]; [`EstimationError::Interrupted`] where the observer ended the search.
    pub fn friction_speeds(
        &self,
        samples: &Samples,
        shape: ShapeParameter,
        observer: &dyn Observer,
    ) -> Result<Option<FrictionSpeeds>, EstimationError> {
        FrictionSpeeds::find(&self.robot, self.columns(), &self.base, samples, shape, observer)
    }

    /// The equations of one experiment.
    ///
    /// # Errors
    /// As [`observe`].
    pub fn observation(&self, samples: &Samples) -> Result<Observation, EstimationError> {
        observe(&self.robot, &self.regressor, &self.base, samples)
    }

    /// The equations of one experiment for tests of terms.
    pub(super) fn observation_of_test(&self, samples: &Samples) -> Result<Observation, EstimationError> {
        load_fit::observe_to(&self.robot, &self.regressor, &self.base, samples, load_fit::REST_OF_TESTS)
    }

    /// The equations of one experiment with friction of the load at the torque that the links take by β (b), and the load that they carry:
    /// linear in all coefficients, and of the torque as it was measured.
    ///
    /// # Errors
    /// [`EstimationError`] where the samples are of another robot.
    pub fn observation_at(
        &self,
        samples: &Samples,
        beta: &DVector<f64>,
        load: &Inertia,
    ) -> Result<Observation, EstimationError> {
        let mut links = load_friction::standard(&self.base, beta);
        for (column, value) in self.base.columns_of_last_link().into_iter().zip(load.to_array()) {
            links[column] += value;
        }
        let regressor = self.regressor.with_links(&links[..10 * self.robot.dof()]);
        Ok(Observation::stacked(&self.robot, &regressor, &self.base, samples, None)?.0)
    }

    /// Equations that are only predicted, linearised where those of the fit are.
    pub(super) fn unseen(&self, samples: &Samples, fitted: &Observation) -> Result<Observation, EstimationError> {
        let at = fitted.linear_at.as_ref();
        Ok(Observation::stacked(&self.robot, &self.regressor, &self.base, samples, at)?.0)
    }

    pub(super) fn problem<'b>(&'b self, observation: &'b Observation, samples: &'b Samples) -> EstimationProblem<'b> {
        EstimationProblem {
            robot: Some(&self.robot),
            samples: Some(samples),
            nominal: self.nominal.as_ref(),
            start: self.start.as_ref(),
            closed_loop: self.closed_loop.as_deref(),
            ..EstimationProblem::new(observation)
        }
    }

    /// Compares what an estimate predicts with samples that it was not made from.
    ///
    /// # Errors
    /// [`EstimationError`] where estimate, samples and robot do not belong together.
    pub fn validate(&self, estimate: &Estimate, samples: &Samples) -> Result<Validation, EstimationError> {
        validate(estimate, &estimate.regressor(&self.robot, self.columns())?, samples)
    }
}
