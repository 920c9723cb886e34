//! Everything of a study that is fixed before its first run: the robot, its reduction, the scorer, the settings.
//!
//! ```text
//! StudySetup::new → designs_of_sequence(family, start) → bound_of_sequence(exact) → outcome(run, performed) → conditions
//! ```
//! Each step is a function of the plan and its seed alone, so that any of them can be done again, in any order, on any
//! number of threads, and give the same bytes. Who performs the experiment is the caller's choice: an [`Arm`].

use std::sync::Arc;

use nalgebra::DMatrix;

use super::bound::{cramer_rao_std, torque_covariance};
use super::condition::ConditionResult;
use super::design::StudyDesign;
use super::error::StudyError;
use super::evidence::{DesignRow, Evidence, Findings};
use super::measured_motion::MeasuredMotions;
use super::more_terms::{MoreTerms, PlannedEstimator};
use super::outcome::ScoredEstimate;
use super::own_methods::OwnMethods;
use super::performed::Performed;
use super::plan::StudyPlan;
use super::plan_error::StudyPlanError;
use super::random_truth::{Centre, TruthError};
use super::run_error::RunError;
use super::run_order::RunOrder;
use super::run_table::{RunNumber, RunTable};
use super::scorer::Scorer;
use super::truth::Truth;
use super::validation::ValidationMotions;
use super::variance_reduction::VarianceReduction;
use crate::base::{BaseReduction, Method, reduce};
use crate::dynamics::States;
use crate::estimation::{
    ClosedLoop, ClosedLoopError, ClosedLoopFactory, Estimate, EstimationError, EstimationProblem, Factorisation,
    Observation, closed_loop_of, observe,
};
use crate::experiment::{Arm, Ending, ExperimentPlan, record};
use crate::model::{Columns, Robot, StandardParameters, distinct};
use crate::observer::{Observer, Unobserved};
use crate::regressor::JointTorqueRegressor;
use crate::seed::RunNoise;
use crate::signal::{Derivatives, Processing, Samples, process};
use crate::trajectory::PeriodicTrajectory;

/// A design that a study plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedDesign {
    /// Its family, from zero.
    pub family: usize,
    /// Its start within the family, from zero.
    pub start: usize,
}

/// A study that is ready to run.
#[derive(Debug)]
pub struct StudySetup {
    /// The plan.
    pub plan: StudyPlan,
    /// The robot.
    pub robot: Robot,
    pub(super) nominal: StandardParameters,
    pub(super) regressor: JointTorqueRegressor,
    /// The reduction to base parameters.
    pub base: BaseReduction,
    pub(super) noise: DMatrix<f64>,
    truths: Vec<Truth>,
    /// The scorer, which holds the truth.
    pub scorer: Scorer,
    pub(super) estimators: Vec<PlannedEstimator>,
    /// Columns beside those of the plan that estimators have.
    pub(super) more: Vec<MoreTerms>,
    /// The methods from outside.
    pub own: OwnMethods,
    closed_loops: Option<ClosedLoopFactory>,
    processing: Processing,
    /// The motions on which predictions are tested.
    pub validation: ValidationMotions,
}

/// What an estimator may look at of an experiment.
pub(super) struct Processed {
    pub(super) samples: Samples,
    pub(super) closed_loop: Result<Arc<dyn ClosedLoop>, ClosedLoopError>,
}

impl StudySetup {
    /// Reduces the robot, draws the truths and the validation motions, and makes the scorer.
    ///
    /// # Errors
    /// [`StudyError`] where the plan, the robot or the validation motions do not allow it.
    pub fn new(plan: StudyPlan, robot: Robot, nominal: StandardParameters, truth: &Truth) -> Result<Self, StudyError> {
        Self::with_methods(plan, robot, nominal, truth, OwnMethods::default())
    }

    /// Prepares a study with methods from outside, which the plan may name.
    ///
    /// # Errors
    /// As [`StudySetup::new`].
    pub fn with_methods(
        plan: StudyPlan,
        robot: Robot,
        nominal: StandardParameters,
        truth: &Truth,
        own: OwnMethods,
    ) -> Result<Self, StudyError> {
        plan.check_with(&own)?;
        let declared = if plan.uncertainty.is_none() { robot.uncertainty().clone() } else { plan.uncertainty.clone() };
        let robot = robot.with_uncertainty(declared);
        let columns = plan.columns()?;
        // What the score compares has the load of the nominal links; the equations find their own.
        let regressor = JointTorqueRegressor::with_load(&robot, columns, &nominal);
        let base = reduce(&robot, columns, Method::Structural, plan.seed)?;
        let validation = ValidationMotions::draw(&robot, &nominal, &plan.experiment, &plan.validation, plan.seed)?;
        let truths = draw_truths(&plan, truth, &nominal)?;
        let scorer =
            |regressor: &_, base: &_| Scorer::new(&robot, &truths, regressor, base, &validation, &plan.reference);
        let estimators = plan.planned_estimators(&own)?;
        let more = distinct(estimators.iter().filter_map(|planned| planned.more)).into_iter().map(
            |columns| -> Result<MoreTerms, StudyError> {
                let regressor = JointTorqueRegressor::with_load(&robot, columns, &nominal);
                let own = reduce(&robot, columns, Method::Structural, plan.seed)?;
                let scorer = scorer(&regressor, &own);
                Ok(MoreTerms::new(columns, (regressor, own, scorer), &base)?)
            },
        );
        let more = more.collect::<Result<_, _>>()?;
        let scorer = scorer(&regressor, &base);
        let processing = Processing {
            derivatives: plan.derivatives()?,
            samples_per_period: plan.identification.samples_per_period,
            ..Processing::default()
        };
        Ok(Self {
            noise: torque_covariance(&robot),
            estimators,
            more,
            own,
            closed_loops: None,
            plan,
            robot,
            nominal,
            regressor,
            base,
            truths,
            scorer,
            processing,
            validation,
        })
    }

    /// Adds what makes the closed loop of an experiment, for estimators that simulate.
    #[must_use]
    pub fn with_closed_loops(self, factory: ClosedLoopFactory) -> Self {
        Self { closed_loops: Some(factory), ..self }
    }

    /// The true parameters of the arm in this run.
    pub fn truth(&self, run: u64) -> &Truth {
        &self.truths[self.plan.truth_of(run)]
    }

    /// Every design of the plan, in the order in which designs are numbered.
    pub fn designs(&self) -> Vec<PlannedDesign> {
        let families = self.plan.designs.iter().enumerate();
        families.flat_map(|(family, plan)| (0..plan.starts).map(move |start| PlannedDesign { family, start })).collect()
    }

    /// The experiment that performs a trajectory.
    pub fn experiment(&self, trajectory: &PeriodicTrajectory) -> ExperimentPlan {
        let settings = &self.plan.experiment;
        ExperimentPlan {
            rate_hz: settings.rate_hz,
            discarded_periods: settings.discarded_periods,
            periods: settings.periods,
            ..ExperimentPlan::new(trajectory.clone())
        }
    }

    /// The order of all runs.
    pub fn run_order(&self) -> RunOrder {
        let runs = self.designs().iter().map(|design| self.plan.runs_of(design.family)).collect();
        RunOrder::new(runs, self.plan.conditions().len())
    }

    /// Every number of a run that findings are made of.
    pub fn run_numbers(&self) -> Vec<RunNumber> {
        RunNumber::all(self.plan.identification.estimators.len(), self.base.rank())
    }

    /// The random numbers of one run: the same under every condition, and what the plan's [`VarianceReduction`] makes of them.
    pub fn noise_of(&self, design: usize, run: u64) -> RunNoise {
        let PlannedDesign { family, start } = self.designs()[design];
        let before = self.plan.designs[..family].iter().map(|family| family.of_starts.unwrap_or(family.starts));
        let common = self.plan.reduces_variance(VarianceReduction::CommonNoise);
        let index = if common { start } else { before.sum::<usize>() + start };
        let seed = self.plan.seed.child("run", index as u64);
        if !self.plan.reduces_variance(VarianceReduction::AntitheticNoise) {
            return seed.of_run(run);
        }
        let pair = seed.of_run(run / 2);
        if run.is_multiple_of(2) { pair } else { pair.opposite() }
    }

    /// Cramér–Rao standard deviations if each state stands for `weight` raw samples of one period.
    pub(super) fn bound_with_weight(&self, exact: &States, weight: f64) -> Vec<f64> {
        let periods = self.plan.experiment.periods;
        cramer_rao_std(&self.regressor, &self.base, exact, &self.noise, weight, periods)
            .unwrap_or_else(|| vec![f64::INFINITY; self.base.rank()])
    }

    /// Raw samples in one period.
    pub(super) fn raw_samples(&self) -> f64 {
        self.plan.experiment.period_s * self.plan.experiment.rate_hz
    }

    /// Performs the experiment and processes the recording.
    ///
    /// # Errors
    /// [`RunError`], as the study's rows state it.
    pub fn samples(&self, trajectory: &PeriodicTrajectory, arm: &mut dyn Arm) -> Result<Samples, RunError> {
        self.processed(record(arm, &self.experiment(trajectory))).map(|processed| processed.samples)
    }

    /// The samples of what came of an experiment, and the closed loop in which it was performed.
    pub(super) fn processed(&self, performed: Performed) -> Result<Processed, RunError> {
        let (recording, ending) = performed.map_err(|fault| RunError::arm(&fault))?;
        match ending {
            Ending::Diverged { t, reason, .. } => return Err(RunError::diverged(t, &reason)),
            Ending::Tripped { t, trip, .. } => return Err(RunError::tripped(t, &trip)),
            Ending::Completed | Ending::Stopped { .. } => {}
        }
        let samples = process(&recording, &self.robot, &self.processing).map_err(|fault| RunError::signal(&fault))?;
        let closed_loop = closed_loop_of(self.closed_loops, &self.robot, Some(&self.nominal), &[Some(&recording)]);
        Ok(Processed { samples, closed_loop })
    }

    /// What an arm measured on the motions that the plan has it perform beside its runs.
    ///
    /// # Errors
    /// [`RunError`] where one of them could not be recorded or processed.
    pub fn measured_motions(&self, performed: Vec<Performed>) -> Result<MeasuredMotions, RunError> {
        let equations = |motion| -> Result<_, RunError> {
            let samples = self.processed(motion)?.samples;
            let observation = Observation::new(&self.robot, &self.regressor, &self.base, &samples);
            Ok((observation.map_err(|fault| RunError::estimator(&fault))?, samples))
        };
        Ok(MeasuredMotions::new(performed.into_iter().map(equations).collect::<Result<_, _>>()?))
    }

    /// Every estimator of the plan on the same samples, each with its score against one of the truths; those that simulate
    /// need to know the experiment behind the samples, and fail.
    pub fn estimates(&self, samples: &Samples, truth: usize) -> Vec<ScoredEstimate> {
        let closed_loop = Err(ClosedLoopError::NoReference);
        self.scored(&Processed { samples: samples.clone(), closed_loop }, truth, None, &Unobserved)
    }

    /// Every estimator on the same samples, scored by what that arm measured afterwards too.
    pub(super) fn scored(
        &self,
        processed: &Processed,
        truth: usize,
        measured: Option<&MeasuredMotions>,
        observer: &dyn Observer,
    ) -> Vec<ScoredEstimate> {
        let scored = |(made, planned): (Result<Estimate, RunError>, &PlannedEstimator)| match made {
            Ok(estimate) => match self.more.iter().find(|more| planned.more == Some(more.columns)) {
                Some(more) => more.scored(&planned.name, &estimate, (&self.robot, &self.scorer), (truth, measured)),
                None => ScoredEstimate::new(&estimate, self.scorer.score(&estimate.beta(), truth, measured)),
            },
            Err(failure) => ScoredEstimate::failed(&planned.name, failure),
        };
        self.unscored(processed, observer).into_iter().zip(&self.estimators).map(scored).collect()
    }

    /// Every estimator of the plan on the same samples, or the reason why it gave nothing.
    pub(super) fn unscored(&self, processed: &Processed, observer: &dyn Observer) -> Vec<Result<Estimate, RunError>> {
        let usual = [(None, &self.regressor, &self.base)].into_iter();
        let sets = usual.chain(self.more.iter().map(|more| (Some(more.columns), &more.regressor, &more.base)));
        let mut all: Vec<_> = sets.flat_map(|set| self.with_columns(set, processed, observer)).collect();
        all.sort_by_key(|(place, _)| *place);
        all.into_iter().map(|(_, made)| made.map_err(|fault| RunError::estimator(&fault))).collect()
    }

    /// The estimators of one set of columns, each with its place among all.
    fn with_columns(
        &self,
        (more, regressor, base): (Option<Columns>, &JointTorqueRegressor, &BaseReduction),
        processed: &Processed,
        observer: &dyn Observer,
    ) -> Vec<(usize, Result<Estimate, EstimationError>)> {
        let samples = &processed.samples;
        let own: Vec<_> = self.estimators.iter().enumerate().filter(|(_, planned)| planned.more == more).collect();
        let all = || -> Result<Vec<_>, EstimationError> {
            let observation = observe(&self.robot, regressor, base, samples)?;
            let equations = Factorisation::new(&observation)?;
            let problem = EstimationProblem {
                factorisation: Some(&equations),
                robot: Some(&self.robot),
                nominal: Some(&self.nominal),
                samples: Some(samples),
                closed_loop: processed.closed_loop.as_deref(),
                observer,
                ..EstimationProblem::new(&observation)
            };
            Ok(own.iter().map(|(_, planned)| planned.estimator.estimate(&problem)).collect())
        };
        let all = all().unwrap_or_else(|fault| vec![Err(fault); own.len()]);
        own.iter().map(|(place, _)| *place).zip(all).collect()
    }

    /// The results under each condition; `bounds` holds the Cramér–Rao standard deviations of each design.
    ///
    /// # Errors
    /// [`StudyError::Runs`] where the numbers of the runs cannot be read.
    pub fn conditions(
        &self,
        designs: &[StudyDesign],
        bounds: &[Vec<f64>],
        runs: &dyn RunTable,
    ) -> Result<Vec<ConditionResult>, StudyError> {
        let conditions = self.plan.conditions().into_iter().enumerate();
        conditions
            .map(|(index, condition)| {
                let findings = self.findings(designs, bounds, runs, index)?;
                Ok(ConditionResult { condition, statuses: runs.statuses(index), findings })
            })
            .collect()
    }

    /// The findings under one condition.
    fn findings(
        &self,
        designs: &[StudyDesign],
        bounds: &[Vec<f64>],
        runs: &dyn RunTable,
        condition: usize,
    ) -> Result<Findings, StudyError> {
        let families: Vec<String> = self.plan.designs.iter().map(|family| family.name.clone()).collect();
        let values: Vec<Vec<(&str, f64)>> = designs.iter().map(StudyDesign::values).collect();
        let mut rows = Vec::new();
        for ((design, bound_std), values) in designs.iter().zip(bounds).zip(&values) {
            let start = self.shared_start(design.family, design.start);
            rows.push(DesignRow { family: design.family, start, bound_std, values });
        }
        Evidence {
            families: &families,
            designs: &rows,
            estimators: &self.plan.identification.estimators,
            truths: self.scorer.truths.len() - 1,
            units: &self.scorer.units,
            runs,
            condition,
            compare_with: &self.plan.compare_with,
            runs_of_noise: self.plan.runs_of_noise(),
            runs_are_matched: self.plan.truths.is_some() || self.plan.reduces_variance(VarianceReduction::CommonNoise),
            draws_effects: self.plan.truths.as_ref().is_some_and(|truths| truths.draw_effects),
            seed: self.plan.seed.child("bootstrap", 0),
        }
        .findings()
    }
}

/// Every truth of the study: the robot's own, then those that are drawn.
fn draw_truths(plan: &StudyPlan, own: &Truth, nominal: &StandardParameters) -> Result<Vec<Truth>, TruthError> {
    let mut truths = vec![own.clone()];
    if let Some(random) = &plan.truths {
        let centre = match random.around {
            Centre::Truth => own.clone(),
            Centre::Nominal => Truth { parameters: nominal.clone(), ..own.clone() },
        };
        truths.extend(random.draw(&centre, plan.seed)?);
    }
    Ok(truths)
}

impl StudyPlan {
    /// The derivative route.
    ///
    /// # Errors
    /// [`StudyPlanError::Name`].
    pub fn derivatives(&self) -> Result<Derivatives, StudyPlanError> {
        let found = &self.identification.derivatives;
        Derivatives::parse(found).ok_or_else(|| {
            super::plan_error::name("identification.derivatives", found, Derivatives::ALL.map(Derivatives::name))
        })
    }
}
