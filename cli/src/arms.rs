//! The arms that can perform an experiment: one word switches between them.

use std::path::Path;

use armid::experiment::{Arm, Ending, Replay, Sink, Tracking};
use armid::seed::Seed;
use armid_sim::Engine;
use miette::Result;

use crate::fault::Fault;
use crate::files::experiment_toml::Experiment;
use crate::files::log;
use crate::simulated_arm::Simulation;

/// Every arm, listed once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArmKind {
    /// The arm simulated by an engine.
    Simulated(Engine),
    /// A stored recording.
    Replay,
}

impl ArmKind {
    /// Those that simulate.
    pub(crate) const SIMULATED: [Self; Engine::ALL.len()] = {
        let mut arms = [Self::Replay; Engine::ALL.len()];
        let mut i = 0;
        while i < arms.len() {
            arms[i] = Self::Simulated(Engine::ALL[i]);
            i += 1;
        }
        arms
    };

    pub(crate) const ALL: [Self; Self::SIMULATED.len() + 1] = {
        let mut arms = [Self::Replay; Self::SIMULATED.len() + 1];
        let mut i = 0;
        while i < Self::SIMULATED.len() {
            arms[i] = Self::SIMULATED[i];
            i += 1;
        }
        arms
    };

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Simulated(engine) => engine.name(),
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
        ArmKind::Simulated(_) => {
            let simulation = Simulation::of(experiment.robot.clone(), kind)?.with_effects(experiment.effects.clone());
            let mut servo = simulation
                .servo(&experiment.sensing)
                .map_err(|error| fault(&error))?
                .with_seed(Seed::new(experiment.seed), experiment.run);
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
