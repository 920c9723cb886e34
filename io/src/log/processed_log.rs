//! Logs that have become samples.

use std::borrow::Cow;

use armid::estimation::{ClosedLoopFactory, Estimate, PositionServo};
use armid::model::{EffortInterface, StandardParameters};
use armid::remedy::{Remedy, Setting};
use armid::signal::Samples;

use super::effort_scale::EffortScale;
use super::joint_log::Log;
use super::log_report::LogReport;
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
    /// The samples, log by log.
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

impl ProcessedLog {
    /// Several logs of one robot as one.
    ///
    /// # Errors
    /// [`Error`] where they are of unlike robots, rates or blocks, or there are none.
    pub fn join(logs: Vec<Self>) -> Result<Self, Error> {
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
            Samples::join(all.parts.clone()).map_err(|error| Error::mismatch(format!("{}: {error}", all.name())))?;
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

    /// The factors by which the efforts of these logs became torques, n: torque constants of a mapping or of the robot, or the stiffness of servos.
    ///
    /// # Errors
    /// [`Error`] where a log holds torques, or those of servos with damping, or the logs state unlike constants.
    pub fn stated_scale(&self) -> Result<(EffortScale, Vec<f64>), Error> {
        let robot = &self.robot.robot;
        let of_robot = || robot.joints().iter().map(|joint| joint.drive.torque_constant).collect::<Vec<_>>();
        let mut all: Option<(EffortScale, Vec<f64>)> = None;
        for log in &self.logs {
            let effort = log.effort_unit.unwrap_or_else(|| robot.effort());
            if log.origin.commands().and_then(|map| map.kd.as_ref()).is_some_and(|kd| kd.iter().any(|kd| *kd != 0.0)) {
                let message = format!("{} states kd, expected kd=0: stiffness alone scales a torque then", log.name);
                return Err(Error::mismatch(message).help("viscous friction holds the damping of the servos"));
            }
            let stated = match (log.origin.scale(log.dof), effort) {
                (Some(scale), _) => scale,
                (None, EffortInterface::Current) => (EffortScale::RobotConstant, of_robot()),
                (None, EffortInterface::Torque) => {
                    let message =
                        format!("{} holds torques, expected motor currents: torques have no torque constant", log.name);
                    let help =
                        Remedy::from("name the columns of the currents: ").assign(Setting::Map, "…, current=i_[1-6]");
                    let help =
                        help.say(", or say that the efforts are currents by ").assign(Setting::Effort, "current");
                    return Err(Error::mismatch(message).help(help));
                }
            };
            if all.as_ref().is_some_and(|all| *all != stated) {
                let message = format!("{} states other torque constants than the log before it", log.name);
                return Err(Error::mismatch(message).help(Remedy::from("give all logs one ").setting(Setting::Map)));
            }
            all = Some(stated);
        }
        Ok(all.unwrap_or_else(|| (EffortScale::RobotConstant, of_robot())))
    }

    /// The servos that made the torques of commanded positions; none where a log holds other efforts, or the logs state other servos.
    pub fn servo(&self) -> Option<&PositionServo> {
        let first = self.logs.first()?.servo.as_ref()?;
        self.logs.iter().all(|log| log.servo.as_ref() == Some(first)).then_some(first)
    }

    /// Nothing is unknown of the servos, which `what` needs.
    ///
    /// # Errors
    /// [`Error`] with what is not known.
    pub fn check_servo(&self, what: &str) -> Result<(), Error> {
        let Some(log) = self.logs.iter().find(|log| log.servo.as_ref().is_some_and(|of| !of.unknown.is_empty())) else {
            return Ok(());
        };
        let parts = log.servo.iter().flat_map(|of| &of.unknown).map(ToString::to_string);
        let names = parts.collect::<Vec<_>>().join(", ");
        let message = format!("{}: {names} of the servo is unknown, expected it to be known for {what}", log.name);
        let help = Remedy::set(Setting::Estimator, "cloe").say(" estimates it; then state it in ");
        Err(Error::mismatch(message).help(help.setting(Setting::Map).say(" without unknown=")))
    }

    /// Torques and positions by the servos that an estimate found, which are those of the logs then. Nothing changes for one that found none.
    ///
    /// # Errors
    /// [`Error`] where the estimate, which errors call `name`, found other numbers than are unknown of these logs.
    pub fn take_servo(&mut self, estimate: &Estimate, name: &str) -> Result<(), Error> {
        if estimate.servo.is_empty() {
            return Ok(());
        }
        let values: Vec<f64> = estimate.servo.iter().map(|part| part.value).collect();
        let names: Vec<&str> = estimate.servo.iter().map(|part| part.name.as_str()).collect();
        let Some(stated) = self.servo().filter(|of| !of.unknown.is_empty()).cloned() else { return Ok(()) };
        let unknown: Vec<String> = stated.unknown.iter().map(ToString::to_string).collect();
        if unknown != names {
            let (found, expected) = (names.join(", "), unknown.join(", "));
            return Err(Error::mismatch(format!(
                "{name} holds {found} of the servo, expected {expected}, unknown in the log"
            )));
        }
        let found = PositionServo { unknown: Vec::new(), ..stated.clone().with_unknown(&values) };
        for samples in self.parts.iter_mut().chain(&mut self.held_out) {
            *samples = stated.restated_samples(samples, &found);
        }
        self.samples =
            Samples::join(self.parts.clone()).map_err(|error| Error::mismatch(format!("{}: {error}", self.name())))?;
        for log in &mut self.logs {
            log.servo = Some(found.clone());
        }
        Ok(())
    }

    /// These logs with the servos that an estimate found.
    ///
    /// # Errors
    /// As [`Self::take_servo`]; where numbers are unknown that the estimate does not hold.
    pub fn with_servo_of(&self, estimate: &Estimate, name: &str) -> Result<Cow<'_, Self>, Error> {
        if self.logs.iter().all(|log| log.servo.as_ref().is_none_or(|of| of.unknown.is_empty())) {
            return Ok(Cow::Borrowed(self));
        }
        let mut own = self.clone();
        own.take_servo(estimate, name)?;
        own.check_servo("a validation")?;
        Ok(Cow::Owned(own))
    }

    pub(super) fn is_foreign(&self) -> bool {
        self.logs.iter().all(|log| log.recording.is_none())
    }

    /// Whether they are logs of other tools without periods: the onset of friction is then looked for unless something else is asked.
    pub fn has_no_periods(&self) -> bool {
        self.is_foreign() && self.samples.period_s.is_none()
    }
}
