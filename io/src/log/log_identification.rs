//! What is estimated from logs: parameters, terms, speeds of friction.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;

use armid::diagnosis::standing_joints;
use armid::estimation::{
    ClosedLoop, ClosedLoopError, Estimate, EstimationError, Estimator, EstimatorKind, FrictionSpeeds, Identification,
    ModelFit, ModelGuess, Observation, Selection, closed_loop_of, commanded_loop_of, fit_model, gain_equations, select,
};
use armid::model::term::{ShapeParameter, Stribeck};
use armid::model::{Columns, Robot};
use armid::observer::{Observer, Progress, Unobserved, Work};
use armid::remedy::{Remedy, Setting, Task};
use armid::signal::Samples;
use armid::spatial::Inertia;

use super::processed_log::ProcessedLog;
use crate::error::Error;

/// Whether every joint moves and has equations.
pub(super) fn shows_every_joint(samples: &Samples) -> bool {
    let n = samples.dof();
    let has_equations = |i: usize| samples.used.iter().skip(i).step_by(n).any(|used| *used);
    standing_joints(samples).is_empty() && (0..n).all(has_equations)
}

impl ProcessedLog {
    /// Estimates the base parameters of these columns.
    ///
    /// # Errors
    /// [`Error`] where the motion does not reveal them or the equations have no answer.
    pub fn identify(&self, columns: Columns, estimator: EstimatorKind) -> Result<Estimate, Error> {
        let mut estimates = self.identify_with(columns, &[estimator.estimator()])?;
        estimates.pop().ok_or_else(|| Error::new("no estimator is named, expected one"))
    }

    /// Identifies by several estimators, of the list or from outside, which share base, nominal set and closed loop.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_with(&self, columns: Columns, estimators: &[&dyn Estimator]) -> Result<Vec<Estimate>, Error> {
        self.identify_watched(columns, estimators, &Unobserved)
    }

    /// Identifies by several estimators and reports to an observer, which may end estimators that iterate.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_watched(
        &self,
        columns: Columns,
        estimators: &[&dyn Estimator],
        observer: &dyn Observer,
    ) -> Result<Vec<Estimate>, Error> {
        let mut identification = self.identification(columns).map_err(|error| self.unestimated(&error))?;
        identification.tests_laws = true;
        self.estimates(identification, estimators, observer)
    }

    /// One of two logs of the same motion, for the difference of their estimates. What laws that the model omits do to both is
    /// not in it, so intervals hold no part for such laws, as those of [`Self::identify_watched`] do.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_for_difference(
        &self,
        columns: Columns,
        estimators: &[&dyn Estimator],
        observer: &dyn Observer,
    ) -> Result<Vec<Estimate>, Error> {
        let identification = self.identification(columns).map_err(|error| self.unestimated(&error))?;
        self.estimates(identification, estimators, observer)
    }

    fn estimates(
        &self,
        mut identification: Identification,
        estimators: &[&dyn Estimator],
        observer: &dyn Observer,
    ) -> Result<Vec<Estimate>, Error> {
        let named = |error: EstimationError| self.unestimated(&error);
        if let Some(guess) = self.robot.guess() {
            identification = identification.with_nominal(guess);
        }
        let others = estimators.iter().map(|estimator| estimator.name());
        if let Some(other) = others.into_iter().find(|name| *name != EstimatorKind::Cloe.name()) {
            self.check_servo(&format!("the estimator {other}"))?;
        }
        identification.closed_loop = self.closed_loop();
        identification.start.clone_from(&self.start);
        identification.estimate_watched(&self.samples, estimators, observer).map_err(named)
    }

    /// The loop in which the logs were made.
    fn closed_loop(&self) -> Result<Arc<dyn ClosedLoop>, ClosedLoopError> {
        let (robot, guess) = (&self.robot.robot, self.robot.guess());
        let Some(servo) = self.servo() else {
            let recordings: Vec<_> = self.logs.iter().map(|log| log.recording.as_ref()).collect();
            return closed_loop_of(self.closed_loops, robot, guess, &recordings);
        };
        match self.logs.iter().map(|log| log.segments.len()).find(|segments| *segments > 1) {
            Some(segments) => Err(ClosedLoopError::Gaps { segments }),
            None => commanded_loop_of(self.closed_loops, robot, guess, servo, &self.parts),
        }
    }

    /// Which of these columns' terms the logs decide, by what is held out where anything is.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn select(&self, candidates: Columns) -> Result<Selection, Error> {
        self.select_watched(candidates, &Unobserved)
    }

    /// Selects terms and reports every set of terms that is fitted to an observer, which may end it.
    ///
    /// # Errors
    /// As [`Self::identify`]; of [`crate::ErrorKind::Interrupted`] where the observer ended it.
    pub fn select_watched(&self, candidates: Columns, observer: &dyn Observer) -> Result<Selection, Error> {
        self.check_servo("a selection of terms")?;
        let done = Cell::new(0);
        let identification = |columns| {
            let total = done.replace(done.get() + 1) + 1;
            match observer.observe(Progress { work: Work::Steps, done: total - 1, total }) {
                ControlFlow::Continue(()) => self.identification(columns),
                ControlFlow::Break(()) => Err(EstimationError::Interrupted),
            }
        };
        let found = select(identification, &self.samples, &self.held_out, candidates);
        found.map_err(|error| self.unestimated(&error))
    }

    /// The speeds in which Coulomb friction sets in, which become those of the robot where torque that was not fitted is predicted better with
    /// them; `None` where no column has one, or the motion does not separate one from the other columns.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn find_onset(&mut self, columns: Columns, observer: &dyn Observer) -> Result<Option<FrictionSpeeds>, Error> {
        let shape = ShapeParameter::COULOMB_VELOCITY;
        let found = self.identification(columns).and_then(|of| of.friction_speeds(&self.samples, shape, observer));
        let speeds = match found {
            Err(
                EstimationError::NotExcited { .. } | EstimationError::LeastSquares(_) | EstimationError::NotDefinite,
            ) => {
                return Ok(None);
            }
            found => found.map_err(|error| self.unestimated(&error))?,
        };
        if let Some(speeds) = speeds.as_ref().filter(|speeds| speeds.predict_better()) {
            self.robot.robot = speeds.robot(&self.robot.robot);
        }
        Ok(speeds)
    }

    /// The speeds at which friction falls, by the Stribeck columns among these, which become those of the robot; `None` where there are none.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn find_stribeck_speeds(
        &mut self,
        columns: Columns,
        observer: &dyn Observer,
    ) -> Result<Option<FrictionSpeeds>, Error> {
        self.check_servo("a speed of friction")?;
        let found = self.identification(columns);
        let found = found.and_then(|of| of.friction_speeds(&self.samples, Stribeck::VELOCITY, observer));
        let speeds = found.map_err(|error| self.unestimated(&error))?;
        if let Some(speeds) = &speeds {
            self.robot.robot = speeds.robot(&self.robot.robot);
        }
        Ok(speeds)
    }

    /// The equations of these samples for columns.
    ///
    /// # Errors
    /// [`Error`] where there are fewer equations than parameters, or the robot's geometry is not finite.
    pub fn observation(&self, columns: Columns) -> Result<Observation, Error> {
        let found = self.identification(columns).and_then(|of| of.observation(&self.samples));
        found.map_err(|error| self.unestimated(&error))
    }

    /// The equations of these logs and of those `with` a load that is known, for the gains of all drives.
    ///
    /// # Errors
    /// [`Error`] where there are fewer equations than parameters, or the robot's geometry is not finite.
    pub fn gain_equations(&self, with: &Self, columns: Columns, load: &Inertia) -> Result<[Observation; 2], Error> {
        self.check_servo("the gains of drives")?;
        let found = self.identification(columns);
        let found = found.and_then(|of| gain_equations(&of, [&self.samples, &with.samples], load));
        found.map_err(|error| self.unestimated(&error))
    }

    /// The model with these terms that explains the logs best near a guess, rows in which joints hardly move included; `robot` has the
    /// friction laws of its file.
    ///
    /// # Errors
    /// [`Error`] as [`fit_model`] has them; of [`crate::ErrorKind::Interrupted`] where the observer ended it.
    pub fn fit_model(
        &self,
        robot: &Robot,
        columns: Columns,
        guess: &ModelGuess,
        observer: &dyn Observer,
    ) -> Result<ModelFit, Error> {
        let samples = self.samples.clone().with_slow_blocks();
        fit_model(robot, columns, &samples, guess, observer).map_err(|error| self.unestimated(&error))
    }

    /// What is estimated: the robot's base, or where joints stand still or their torque is left out, the base that the equations reveal.
    pub(super) fn identification(&self, columns: Columns) -> Result<Identification, EstimationError> {
        self.identification_of(&self.robot.robot, columns)
    }

    pub(super) fn identification_of(&self, robot: &Robot, columns: Columns) -> Result<Identification, EstimationError> {
        let all = Identification::new(robot, columns)?;
        if self.is_foreign() && !self.parts.iter().all(shows_every_joint) {
            let shown = Identification::on_motion(robot, columns, &self.samples)?;
            return Ok(if shown.base().rank() < all.base().rank() { shown } else { all });
        }
        Ok(all)
    }

    pub(super) fn unestimated(&self, error: &EstimationError) -> Error {
        let shown = Error::new(format!("{}: {error}", self.name()));
        match error {
            EstimationError::Interrupted => Error::interrupted(&self.name()),
            EstimationError::NotExcited { .. } => {
                let help = Remedy::task(Task::Reduce, "ROBOT").option(Setting::Trajectory, "T.toml");
                let help = help.say(" shows what a motion reveals; ").perform(Task::Design, "");
                shown.help(help.say(" finds one that reveals all"))
            }
            EstimationError::NothingActs { .. } => self.wild_sample().unwrap_or_else(|| self.no_motion()),
            EstimationError::TooFewEquations { .. } | EstimationError::LeastSquares(_) => {
                self.wild_sample().unwrap_or(shown)
            }
            _ => shown,
        }
    }
}
