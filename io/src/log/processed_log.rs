//! Logs that have become samples.

use armid::estimation::ClosedLoopFactory;
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

    /// By what the efforts of these logs became torques, n: torque constants of a mapping or of the robot, or the stiffness of servos.
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
        Ok(all.unwrap_or_else(|| (EffortScale::RobotConstant, of_robot())))
    }

    pub(super) fn is_foreign(&self) -> bool {
        self.logs.iter().all(|log| log.recording.is_none())
    }

    /// Whether they are logs of other tools without periods: the onset of friction is then looked for unless something else is asked.
    pub fn has_no_periods(&self) -> bool {
        self.is_foreign() && self.samples.period_s.is_none()
    }
}
