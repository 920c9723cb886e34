//! The arms that can perform an experiment: one word switches between them.

use std::path::Path;

use armid::experiment::{Arm, Ending, Replay, Servo, Sink, Tracking};
use armid::model::StandardParameters;
use armid::seed::Seed;
use armid_sim::AnalyticPlant;
use miette::Result;

use crate::fault::Fault;
use crate::files::experiment_toml::Experiment;
use crate::files::log;

/// Every arm, listed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArmKind {
    /// The simulated arm with equations of motion of its own.
    Analytic,
    /// A stored recording.
    Replay,
}

impl ArmKind {
    pub(crate) const ALL: [Self; 2] = [Self::Analytic, Self::Replay];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Analytic => "analytic",
            Self::Replay => "replay",
        }
    }

    pub(crate) fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|arm| arm.name() == name)
    }
}

/// An experiment's end, and how well a simulated servo followed its command.
pub(crate) struct Performed {
    pub(crate) ending: Ending,
    pub(crate) tracking: Option<Tracking>,
}

/// Performs an experiment on an arm. `recording` is what `replay` plays.
pub(crate) fn perform(
    kind: ArmKind,
    experiment: &Experiment,
    recording: Option<&Path>,
    sink: &mut dyn Sink,
) -> Result<Performed> {
    let fault = |error: &dyn std::fmt::Display| Fault::new(format!("arm {}: {error}", kind.name()));
    match kind {
        ArmKind::Analytic => {
            let robot = &experiment.robot.robot;
            let truth = experiment.robot.truth()?;
            let nominal = nominal(experiment, &truth);
            let plant = AnalyticPlant::new(robot, &truth).map_err(|error| fault(&error))?;
            let mut servo = Servo::new(robot, &nominal, plant)
                .map_err(|error| fault(&error))?
                .with_seed(Seed::new(experiment.seed), experiment.run)
                .with_sensing(experiment.sensing.clone())
                .with_robot_text(&*experiment.robot.text.content);
            let ending = servo.perform(&experiment.plan, sink).map_err(|error| fault(&error))?;
            Ok(Performed { ending, tracking: servo.tracking().cloned() })
        }
        ArmKind::Replay => {
            let Some(path) = recording else {
                return Err(Fault::new("arm replay needs --recording R.mcap: what it plays").into());
            };
            let log = log::read(path)?;
            let Some(recording) = log.recording else {
                let message = format!("{} was not recorded by armid, expected a recording with its plan", log.name);
                return Err(Fault::new(message).into());
            };
            let ending = Replay(recording).perform(&experiment.plan, sink).map_err(|error| fault(&error))?;
            Ok(Performed { ending, tracking: None })
        }
    }
}

/// What the controller's gains are placed on: the experimenter's guess, and the file's own inertias where there is none.
fn nominal(experiment: &Experiment, own: &StandardParameters) -> StandardParameters {
    experiment.robot.nominal.clone().unwrap_or_else(|| own.clone())
}
