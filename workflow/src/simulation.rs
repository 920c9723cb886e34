//! Simulated arms of robots that were loaded, and experiments on them.

use armid::experiment::{Effects, Ending, ExperimentPlan, Recording, Sensing, Tracking, record_watched};
use armid::observer::Observer;
use armid::seed::Seed;
use armid_io::{Error, LoadedRobot, Log};
use armid_sim::{Engine, SimulatedArm};

/// The arm that an engine simulates of a robot: with the effects and motors of its truth, and further `effects`, which count
/// where both have one.
///
/// # Errors
/// [`Error`] where nothing says what the robot is truly made of.
pub fn simulated_arm(loaded: &LoadedRobot, engine: Engine, effects: Effects) -> Result<SimulatedArm, Error> {
    let arm = SimulatedArm::of(&loaded.robot, loaded.nominal.as_ref(), loaded.truth()?, engine);
    Ok(arm.with_effects(effects).with_robot_text(loaded.text.content.clone()))
}

/// What simulates an experiment, and how.
#[derive(Clone, Debug)]
pub struct SimulationSettings {
    /// The engine.
    pub engine: Engine,
    /// Effects in addition to those of the true arm.
    pub effects: Effects,
    /// The sensors.
    pub sensing: Sensing,
    /// Seed of their noise; 0 unless it is stated, as in an experiment file.
    pub seed: u64,
    /// Number of the run, which has noise of its own.
    pub run: u64,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self { engine: Engine::Analytic, effects: Effects::none(), sensing: Sensing::default(), seed: 0, run: 0 }
    }
}

/// A simulated experiment.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// Its samples, up to its end.
    pub recording: Recording,
    /// How it ended.
    pub ending: Ending,
    /// How well the servo followed its command; none where it did not get to move.
    pub tracking: Option<Tracking>,
}

impl Simulated {
    /// The recording as a log.
    pub fn log(&self) -> Log {
        let name = format!("simulated {}", self.recording.robot);
        Log::of_recording(&name, self.recording.clone(), None)
    }
}

/// Performs an experiment on a simulated arm. An observer that ends it stops the arm: the samples up to there are kept.
///
/// # Errors
/// [`Error`] where the arm cannot be built or the plan cannot be performed.
pub fn simulate(
    loaded: &LoadedRobot,
    plan: &ExperimentPlan,
    settings: &SimulationSettings,
    observer: &dyn Observer,
) -> Result<Simulated, Error> {
    let arm = simulated_arm(loaded, settings.engine, settings.effects.clone())?;
    let servo = arm.servo(&settings.sensing).map_err(Error::new)?;
    let mut servo = servo.with_seed(Seed::new(settings.seed), settings.run);
    let (recording, ending) = record_watched(&mut servo, plan, observer).map_err(Error::new)?;
    Ok(Simulated { recording, ending, tracking: servo.tracking().cloned() })
}
