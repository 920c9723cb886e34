//! Logs that have become samples, and what is done with them.

use std::cell::Cell;
use std::ops::ControlFlow;

use armid::calibration::{TransmissionStiffness, transmission_stiffness};
use armid::diagnosis::{Evidence, Mistake, Suspicion, diagnose, standing_joints};
use armid::estimation::{
    ClosedLoopFactory, Estimate, EstimationError, Estimator, EstimatorKind, FrictionSpeeds, Identification, Model,
    ModelFit, ModelGuess, Observation, ResidualTrends, Selection, TorqueResidual, TorqueSeries, Validation,
    closed_loop_of, fit_model, gain_equations, predict, select,
};
use armid::model::term::{ShapeParameter, Stribeck};
use armid::model::{Columns, EffortInterface, Robot, StandardParameters};
use armid::observer::{Observer, Progress, Unobserved, Work};
use armid::regressor::JointTorqueRegressor;
use armid::remedy::{Remedy, Setting, Task};
use armid::signal::Samples;
use armid::spatial::Inertia;
use serde::Serialize;

use super::gaps::Gaps;
use super::joint_log::Log;
use super::origin::Origin;
use super::settings::LogSettings;
use crate::error::Error;
use crate::robot::LoadedRobot;

/// Logs that have become samples.
#[derive(Clone, Debug)]
pub struct ProcessedLog {
    /// The logs, with the robot's joints in the robot's order.
    pub logs: Vec<Log>,
    /// The robot.
    pub robot: LoadedRobot,
    /// What identification works on: those of all logs, in their order.
    pub samples: Samples,
    /// The same, log by log.
    pub parts: Vec<Samples>,
    /// Samples that are held out.
    pub held_out: Vec<Samples>,
    /// What was found in each log.
    pub reports: Vec<LogReport>,
    /// How they were processed.
    pub settings: LogSettings,
    /// What makes the closed loop of the recordings, for estimators that simulate; none unless it is set.
    pub closed_loops: Option<ClosedLoopFactory>,
    /// Where estimators that simulate begin, in place of the weighted linear fit.
    pub start: Option<StandardParameters>,
}

/// What was found in a log, and how much of it is used.
#[derive(Clone, Debug, Serialize)]
pub struct LogReport {
    /// What it is called.
    pub name: String,
    /// Whether its end is there.
    pub complete: bool,
    /// Periods that were averaged; 1 where it has none.
    pub periods: usize,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Time that is used, s.
    pub used_s: f64,
    /// Time that is held out, s.
    pub held_out_s: f64,
    /// Blocks of samples, each of which could be an equation of every joint.
    pub blocks: usize,
    /// Those that are one, for each joint.
    pub equations: Vec<usize>,
    /// What was missing in a recording of armid's own.
    #[serde(skip)]
    pub gaps: Option<Gaps>,
    /// Where it came from, and what was found in it.
    #[serde(flatten)]
    pub origin: Origin,
}

/// Whether every joint moves and has equations.
fn shows_every_joint(samples: &Samples) -> bool {
    let n = samples.dof();
    let has_equations = |i: usize| samples.used.iter().skip(i).step_by(n).any(|used| *used);
    standing_joints(samples).is_empty() && (0..n).all(has_equations)
}

impl LogReport {
    pub(super) fn new(log: &Log, gaps: Option<Gaps>, used: &Samples, held_out: Option<&Samples>) -> Self {
        let n = used.dof();
        let time = |samples: &Samples| (samples.len() * samples.periods) as f64 / samples.rate_hz;
        Self {
            name: log.name.clone(),
            complete: log.complete,
            periods: used.periods,
            rate_hz: log.rate_hz,
            used_s: time(used),
            held_out_s: held_out.map_or(0.0, time),
            blocks: used.blocks(),
            equations: (0..n).map(|i| used.used.iter().skip(i).step_by(n).filter(|used| **used).count()).collect(),
            gaps,
            origin: log.origin.clone(),
        }
    }
}

impl ProcessedLog {
    /// Several logs of one robot as one.
    ///
    /// # Errors
    /// [`Error`] where they are of unlike robots, rates or blocks, or there are none.
    pub fn joined(logs: Vec<Self>) -> Result<Self, Error> {
        let mut logs = logs.into_iter();
        let mut all = logs.next().ok_or_else(|| Error::new("no log is named, expected at least one"))?;
        for log in logs {
            let (found, expected) = (log.robot.robot.name(), all.robot.robot.name());
            if found != expected {
                let message =
                    format!("{} is of robot \"{found}\", expected \"{expected}\" as the first log", log.name());
                return Err(Error::mismatch(message).help("each robot has an estimate of its own"));
            }
            all.parts.extend(log.parts);
            all.held_out.extend(log.held_out);
            all.reports.extend(log.reports);
            all.logs.extend(log.logs);
        }
        all.samples =
            Samples::joined(all.parts.clone()).map_err(|error| Error::mismatch(format!("{}: {error}", all.name())))?;
        Ok(all)
    }

    /// Takes other logs, whole, as those that are held out.
    pub fn hold_out(&mut self, others: &Self) {
        self.held_out = others.parts.iter().chain(&others.held_out).cloned().collect();
    }

    /// What the logs are called.
    pub fn name(&self) -> String {
        self.logs.iter().map(|log| log.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// Names of the robot's joints.
    pub fn joint_names(&self) -> Vec<String> {
        self.robot.robot.joints().iter().map(|joint| joint.name.clone()).collect()
    }

    /// Estimates the base parameters of these columns.
    ///
    /// # Errors
    /// [`Error`] where the motion does not reveal them or the equations have no answer.
    pub fn identify(&self, columns: Columns, estimator: EstimatorKind) -> Result<Estimate, Error> {
        let mut estimates = self.identify_with(columns, &[estimator.estimator()])?;
        estimates.pop().ok_or_else(|| Error::new("no estimator is named, expected one"))
    }

    /// The same by several estimators, of the list or from outside, which share base, nominal set and closed loop.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_with(&self, columns: Columns, estimators: &[&dyn Estimator]) -> Result<Vec<Estimate>, Error> {
        self.identify_watched(columns, estimators, &Unobserved)
    }

    /// The same, reporting to an observer, which may end estimators that iterate.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn identify_watched(
        &self,
        columns: Columns,
        estimators: &[&dyn Estimator],
        observer: &dyn Observer,
    ) -> Result<Vec<Estimate>, Error> {
        let named = |error: EstimationError| self.unestimated(&error);
        let mut identification = self.identification(columns).map_err(named)?;
        if let Some(guess) = self.robot.guess() {
            identification = identification.with_nominal(guess);
        }
        let recordings: Vec<_> = self.logs.iter().map(|log| log.recording.as_ref()).collect();
        let robot = &self.robot;
        let known = closed_loop_of(self.closed_loops, &robot.robot, robot.guess(), &recordings);
        identification = identification.with_closed_loop(known);
        if let Some(start) = &self.start {
            identification = identification.with_start(start);
        }
        identification.estimate_watched(&self.samples, estimators, observer).map_err(named)
    }

    /// Which of these columns' terms the logs decide, by what is held out where anything is.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub fn select(&self, candidates: Columns) -> Result<Selection, Error> {
        self.select_watched(candidates, &Unobserved)
    }

    /// The same, reporting every set of terms that is fitted to an observer, which may end it.
    ///
    /// # Errors
    /// As [`Self::identify`]; of [`crate::ErrorKind::Interrupted`] where the observer ended it.
    pub fn select_watched(&self, candidates: Columns, observer: &dyn Observer) -> Result<Selection, Error> {
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

    /// The stiffness of every transmission, by what an estimate predicts; `None` where the logs hold no positions of the links. `name` is what errors
    /// call the estimate.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn transmissions(&self, estimate: &Estimate, name: &str) -> Result<Option<Vec<TransmissionStiffness>>, Error> {
        if self.samples.link_q.is_none() {
            return Ok(None);
        }
        let robot = &self.robot.robot;
        let regressor = self.regressor_of(estimate, name)?;
        let modelled = predict(estimate, &regressor, &self.samples.states)
            .map_err(|error| Error::mismatch(format!("{name}: {error}")))?;
        let found = transmission_stiffness(robot, &self.samples, &modelled);
        found.map(Some).map_err(|error| Error::new(format!("{}: {error}", self.name())))
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
        let found = self.identification(columns);
        let found = found.and_then(|of| of.friction_speeds(&self.samples, Stribeck::VELOCITY, observer));
        let speeds = found.map_err(|error| self.unestimated(&error))?;
        if let Some(speeds) = &speeds {
            self.robot.robot = speeds.robot(&self.robot.robot);
        }
        Ok(speeds)
    }

    /// Gives the robot the shape parameters of friction that an estimate was made with. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn take_shape(&mut self, estimate: &Estimate, name: &str) -> Result<(), Error> {
        let robot = estimate.robot(&self.robot.robot, self.columns_of(estimate, name)?);
        self.robot.robot = robot.map_err(|error| Error::mismatch(format!("{name}: {error}")))?;
        Ok(())
    }

    /// The torque constants by which the currents of these logs became torques, N·m/A, n: those of a mapping, or the robot's.
    ///
    /// # Errors
    /// [`Error`] where a log holds torques, or the logs state unlike constants.
    pub fn stated_constants(&self) -> Result<Vec<f64>, Error> {
        let robot = &self.robot.robot;
        let of_robot = || robot.joints().iter().map(|joint| joint.drive.torque_constant).collect::<Vec<_>>();
        let mut all: Option<Vec<f64>> = None;
        for log in &self.logs {
            let effort = log.effort_unit.unwrap_or_else(|| robot.effort());
            let stated = match (log.origin.constants(log.dof), effort) {
                (Some(constants), _) => constants,
                (None, EffortInterface::Current) => of_robot(),
                (None, EffortInterface::Torque) => {
                    let message =
                        format!("{} holds torques, expected motor currents: torques have no torque constant", log.name);
                    let help =
                        Remedy::from("name the columns of the currents: ").to(Setting::Map, "…, current=i_[1-6]");
                    let help = help.say(", or say that the efforts are currents by ").to(Setting::Effort, "current");
                    return Err(Error::mismatch(message).help(help));
                }
            };
            if all.as_ref().is_some_and(|all| *all != stated) {
                let message = format!("{} states other torque constants than the log before it", log.name);
                return Err(Error::mismatch(message).help(Remedy::from("give all logs one ").setting(Setting::Map)));
            }
            all = Some(stated);
        }
        Ok(all.unwrap_or_else(of_robot))
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
        let found = self.identification(columns);
        let found = found.and_then(|of| gain_equations(&of, [&self.samples, &with.samples], load));
        found.map_err(|error| self.unestimated(&error))
    }

    /// What the residual of an estimate shows on the equations that it was made from.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn residual_trends(&self, estimate: &Estimate, name: &str) -> Result<ResidualTrends, Error> {
        let columns = self.columns_of(estimate, name)?;
        let named = |error: EstimationError| Error::mismatch(format!("{name}: {error}"));
        let robot = estimate.robot(&self.robot.robot, columns).map_err(named)?;
        let observation = self.identification_of(&robot, columns).and_then(|of| of.observation(&self.samples));
        let observation = observation.map_err(|error| self.unestimated(&error))?;
        ResidualTrends::new(&robot, &observation, &self.samples, estimate).map_err(named)
    }

    /// What is estimated: the robot's base, or where joints stand still or their torque is left out, the base that the equations reveal.
    fn identification(&self, columns: Columns) -> Result<Identification, EstimationError> {
        self.identification_of(&self.robot.robot, columns)
    }

    fn identification_of(&self, robot: &Robot, columns: Columns) -> Result<Identification, EstimationError> {
        let all = Identification::new(robot, columns)?;
        if self.is_foreign() && !self.parts.iter().all(shows_every_joint) {
            let shown = Identification::on_motion(robot, columns, &self.samples)?;
            return Ok(if shown.base().rank() < all.base().rank() { shown } else { all });
        }
        Ok(all)
    }

    fn is_foreign(&self) -> bool {
        self.logs.iter().all(|log| log.recording.is_none())
    }

    /// Whether they are logs of other tools without periods: the onset of friction is then looked for unless something else is asked.
    pub fn has_no_periods(&self) -> bool {
        self.is_foreign() && self.samples.period_s.is_none()
    }

    /// Mistakes that the logs seem to have been made with, or in the robot file; none for recordings of armid's own.
    ///
    /// # Errors
    /// [`Error`] where the robot has no base parameters of these columns.
    pub fn suspicions(&self, columns: Columns) -> Result<Vec<Suspicion>, Error> {
        if !self.is_foreign() {
            return Ok(Vec::new());
        }
        let standing = standing_joints(&self.samples);
        if !standing.is_empty() {
            let at_rest = |joint| Suspicion { mistake: Mistake::AtRest { joint }, cost: 0.0, corrected_cost: 0.0 };
            return Ok(standing.into_iter().map(at_rest).collect());
        }
        // A log in which a joint rests or has no torque says too little of the others to find a mistake in it.
        let parts: Vec<Samples> = self.parts.iter().filter(|part| shows_every_joint(part)).cloned().collect();
        let Ok(samples) = Samples::joined(parts) else { return Ok(Vec::new()) };
        let held_out = self.held_out.iter().find(|part| shows_every_joint(part));
        let log = Evidence { samples: &samples, held_out, nominal: self.robot.guess() };
        let found = diagnose(&self.robot.robot, columns, &log);
        Ok(found.map_err(|error| Error::new(format!("{}: {error}", self.name())))?.into_iter().collect())
    }

    /// Compares what an estimate predicts with these logs. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn validate(&self, estimate: &Estimate, name: &str) -> Result<Validation, Error> {
        let columns = self.columns_of(estimate, name)?;
        let named = |error: EstimationError| Error::mismatch(format!("{name}: {error}"));
        let identification = Identification::new(&self.robot.robot, columns);
        identification.and_then(|of| of.validate(estimate, &self.samples)).map_err(named)
    }

    /// How much of the measured torque an estimate leaves unexplained, at the bandwidth of the settings: in what is used,
    /// and in what is held out where anything is.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn residual(&self, estimate: &Estimate, name: &str) -> Result<(TorqueResidual, Option<TorqueResidual>), Error> {
        let regressor = self.regressor_of(estimate, name)?;
        let of = |parts: &[Samples]| {
            TorqueResidual::new(estimate, &regressor, parts, self.settings.bandwidth_hz)
                .map_err(|error| Error::mismatch(format!("{name}: {error}")))
        };
        let held_out = if self.held_out.is_empty() { None } else { Some(of(&self.held_out)?) };
        Ok((of(&self.parts)?, held_out))
    }

    /// The same of a model that was read from a file, which errors call `name`.
    ///
    /// # Errors
    /// [`Error`] where it is of another arm.
    pub fn model_residual(
        &self,
        model: &Model<'_>,
        name: &str,
    ) -> Result<(TorqueResidual, Option<TorqueResidual>), Error> {
        let of = |parts: &[Samples]| {
            TorqueResidual::of_model(model, parts, self.settings.bandwidth_hz)
                .map_err(|error| Error::mismatch(format!("{name}: {error}")))
        };
        let held_out = if self.held_out.is_empty() { None } else { Some(of(&self.held_out)?) };
        Ok((of(&self.parts)?, held_out))
    }

    /// Compares what a model predicts with these logs. `name` is what errors call its file.
    ///
    /// # Errors
    /// As [`Self::model_residual`].
    pub fn validate_model(&self, model: &Model<'_>, name: &str) -> Result<Validation, Error> {
        Validation::of_model(model, &self.samples).map_err(|error| Error::mismatch(format!("{name}: {error}")))
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

    /// Measured and predicted torque of each log, and of what is held out, below the bandwidth of the settings.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn series(&self, estimate: &Estimate, name: &str, parts: &[Samples]) -> Result<Vec<TorqueSeries>, Error> {
        let regressor = self.regressor_of(estimate, name)?;
        let of = |samples: &Samples| {
            let bandwidth = self.settings.bandwidth_hz.min(0.4 * samples.rate_hz);
            TorqueSeries::new(estimate, &regressor, samples, bandwidth)
                .map_err(|error| Error::mismatch(format!("{name}: {error}")))
        };
        parts.iter().map(of).collect()
    }

    /// What each base parameter of an estimate stands for, in its order.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn expressions(&self, estimate: &Estimate, name: &str) -> Result<Vec<String>, Error> {
        let columns = self.columns_of(estimate, name)?;
        let robot = &self.robot.robot;
        let identification = self.identification(columns);
        let identification =
            identification.map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
        let base = identification.base();
        let (names, expressions) = (base.names(), base.expressions(robot));
        estimate
            .base
            .iter()
            .map(|parameter| {
                let at = names.iter().position(|name| *name == parameter.name);
                at.map(|at| expressions[at].clone()).ok_or_else(|| {
                    let message =
                        format!("{name}: \"{}\" is not a base parameter of \"{}\"", parameter.name, robot.name());
                    Error::mismatch(message)
                })
            })
            .collect()
    }

    /// By which an estimate predicts.
    fn regressor_of(&self, estimate: &Estimate, name: &str) -> Result<JointTorqueRegressor, Error> {
        let found = estimate.regressor(&self.robot.robot, self.columns_of(estimate, name)?);
        found.map_err(|error| Error::mismatch(format!("{name}: {error}")))
    }

    fn columns_of(&self, estimate: &Estimate, name: &str) -> Result<Columns, Error> {
        let robot = &self.robot.robot;
        if estimate.robot != robot.name() {
            let message = format!("{name} is of robot \"{}\", expected \"{}\"", estimate.robot, robot.name());
            let help = Remedy::task(Task::Identify, "LOG").with(Setting::Output, "E.json");
            return Err(Error::mismatch(message).help(help.say(" makes an estimate of this robot")));
        }
        Columns::parse(&estimate.columns).ok_or_else(|| {
            let names = Columns::ALL.map(|columns| columns.to_string()).join(", ");
            Error::new(format!("{name}: columns is \"{}\", expected one of {names}", estimate.columns))
        })
    }

    fn unestimated(&self, error: &EstimationError) -> Error {
        let shown = Error::new(format!("{}: {error}", self.name()));
        match error {
            EstimationError::Interrupted => Error::interrupted(&self.name()),
            EstimationError::NotExcited { .. } => {
                let help = Remedy::task(Task::Reduce, "ROBOT").with(Setting::Trajectory, "T.toml");
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
