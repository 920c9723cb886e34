//! A simulated arm: true parameters, effects and motors in an engine, under the servo of the robot file.

use std::sync::Arc;

use armid::dynamics::{Dynamics, States};
use armid::experiment::{
    ActualArm, Arm, ArmError, Discarding, Effects, Ending, ExperimentPlan, Phase, Plant, Sensing, Servo, ServoError,
    record_watched,
};
use armid::model::{Robot, StandardParameters};
use armid::observer::Observer;
use armid::seed::RunNoise;
use armid::study::{Performed, Truth, exact_states};

use crate::analytic::record_runs_watched;
use crate::{AnalyticPlant, BatchRun, Engine, EngineError};

/// Why a simulated arm cannot be built, or cannot perform a plan.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
#[non_exhaustive]
pub enum SimulationError {
    /// The engine cannot simulate the robot.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The servo cannot be built.
    #[error(transparent)]
    Servo(#[from] ServoError),
    /// The plan cannot be performed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// The closed loop ran away.
    #[error("the noise-free motion diverged at t = {t:.3} s: {reason}")]
    Diverged { t: f64, reason: String },
}

/// A robot that can be simulated: its model, what its servo assumes, what it is truly made of, and the engine.
///
/// Effects and motors of the truth are in every servo made from it. `armid-workflow` makes one of a loaded robot.
///
/// ```
/// use armid::experiment::{ExperimentPlan, Sensing, record};
/// use armid::model::bundled;
/// use armid::model::format::{parse_nominal, parse_robot};
/// use armid::study::{Truth, radkhah2007::table_one, truth_text};
/// use armid_sim::{Engine, SimulatedArm};
///
/// let entry = bundled()[0];
/// let robot = parse_robot(entry.robot)?;
/// let nominal = parse_nominal(entry.nominal, &robot)?.parameters;
/// let truth = Truth::from_toml(truth_text(entry.name).ok_or("a bundled robot has a truth")?, &robot)?;
/// let arm = SimulatedArm::of(&robot, Some(&nominal), truth, Engine::Analytic);
/// let plan = ExperimentPlan::new(table_one::corrected()).with_periods(1);
/// let (recording, ending) = record(&mut arm.servo(&Sensing::default())?, &plan)?;
/// assert!(ending.is_complete() && recording.periods() == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedArm {
    /// The robot.
    pub robot: Robot,
    /// The parameters that its servo is tuned by.
    pub nominal: StandardParameters,
    /// What it is made of.
    pub truth: Truth,
    engine: Engine,
    /// Added to those of the truth; where both have one, these count.
    effects: Effects,
    robot_text: Arc<str>,
}

impl SimulatedArm {
    /// The arm with this truth. Its servo is tuned by the `nominal` parameters, or by the true ones where there are none.
    pub fn of(robot: &Robot, nominal: Option<&StandardParameters>, truth: Truth, engine: Engine) -> Self {
        let nominal = nominal.unwrap_or(&truth.parameters).clone();
        Self { robot: robot.clone(), nominal, truth, engine, effects: Effects::none(), robot_text: "".into() }
    }

    /// Returns this arm with further effects. They replace those of its truth.
    #[must_use]
    pub fn with_effects(self, effects: Effects) -> Self {
        Self { effects, ..self }
    }

    /// Returns this arm; its recordings hold this text of the robot file.
    #[must_use]
    pub fn with_robot_text(self, text: impl Into<Arc<str>>) -> Self {
        Self { robot_text: text.into(), ..self }
    }

    /// Returns this arm with another truth; robot, servo and effects stay.
    #[must_use]
    pub fn with_truth(&self, truth: &Truth) -> Self {
        Self { truth: truth.clone(), ..self.clone() }
    }

    /// The arm for one run, with these sensors.
    ///
    /// # Errors
    /// [`SimulationError`] where the arm cannot be built.
    pub fn arm(&self, sensing: &Sensing, noise: RunNoise) -> Result<Box<dyn Arm>, SimulationError> {
        Ok(Box::new(self.servo(sensing)?.with_noise(noise)))
    }

    /// The plant with the controller and the sensors of the real arm around it.
    ///
    /// # Errors
    /// [`SimulationError`] where the arm cannot be built.
    pub fn servo(&self, sensing: &Sensing) -> Result<Servo<Box<dyn Plant>>, SimulationError> {
        self.servo_of(&self.all_effects(), sensing)
    }

    /// The plant without effects, for callers that bring their own servo.
    ///
    /// # Errors
    /// [`SimulationError`] where the engine cannot simulate it.
    pub fn plant(&self) -> Result<Box<dyn Plant>, SimulationError> {
        self.plant_of(&self.actual(&Effects::none()))
    }

    /// States of one recorded period of the closed loop with noise-free sensors, about 500 of them; of the arm
    /// without effects, which the true parameters describe.
    ///
    /// # Errors
    /// [`SimulationError`] where the arm cannot be built or perform the plan, or runs away.
    pub fn exact_period(&self, plan: &ExperimentPlan) -> Result<States, SimulationError> {
        let mut servo = self.servo_of(&Effects::none(), &Sensing::ideal())?;
        let plan = plan.clone().with_periods(1);
        let period = plan.layout().map_err(ArmError::from)?.period_samples;
        let stride = (1..=period / 500).rev().find(|stride| period % stride == 0).unwrap_or(1);
        let (mut q, mut qd, mut tau) = (Vec::new(), Vec::new(), Vec::new());
        let ending = servo.perform_observed(&plan, &mut Discarding, &mut |state| {
            if state.phase == Phase::Record && state.index % stride == 0 {
                q.extend_from_slice(state.q);
                qd.extend_from_slice(state.qd);
                tau.extend_from_slice(state.tau);
            }
        })?;
        if let Ending::Diverged { t, reason, .. } = ending {
            return Err(SimulationError::Diverged { t, reason: reason.to_string() });
        }
        Ok(exact_states(&mut Dynamics::new(&self.robot, &self.truth.parameters), &q, &qd, &tau))
    }

    /// What came of every run, each with the bits that it would have alone. Where the engine has lanes the runs are computed
    /// side by side. An observer may stop them.
    ///
    /// # Errors
    /// [`SimulationError`] where the arm cannot be built.
    pub fn record_all(
        &self,
        runs: &[BatchRun<'_>],
        observer: &dyn Observer,
    ) -> Result<Vec<Performed>, SimulationError> {
        let sensing = Sensing::default();
        if self.engine == Engine::Analytic {
            let actual = self.actual(&self.all_effects());
            let plant = AnalyticPlant::new(actual.robot(), actual.parameters())
                .map_err(|fault| EngineError { engine: self.engine, reason: fault.to_string() })?;
            return Ok(record_runs_watched(&self.servo_around(plant, actual, &sensing)?, runs, observer));
        }
        runs.iter().map(|run| Ok(record_watched(&mut *self.arm(&sensing, run.noise)?, run.plan, observer))).collect()
    }

    fn all_effects(&self) -> Effects {
        self.truth.effects.overridden_by(&self.effects)
    }

    fn actual(&self, effects: &Effects) -> ActualArm {
        ActualArm::new(effects, &self.robot, &self.truth.parameters)
    }

    fn plant_of(&self, actual: &ActualArm) -> Result<Box<dyn Plant>, SimulationError> {
        Ok(self.engine.plant(actual.robot(), actual.parameters())?)
    }

    fn servo_of(&self, effects: &Effects, sensing: &Sensing) -> Result<Servo<Box<dyn Plant>>, SimulationError> {
        let actual = self.actual(effects);
        let plant = self.plant_of(&actual)?;
        self.servo_around(plant, actual, sensing)
    }

    fn servo_around<P: Plant>(
        &self,
        plant: P,
        actual: ActualArm,
        sensing: &Sensing,
    ) -> Result<Servo<P>, SimulationError> {
        let servo = Servo::new(&self.robot, &self.nominal, plant)?;
        let servo = servo.with_sensing(sensing.clone()).with_effects(actual).with_robot_text(self.robot_text.as_ref());
        Ok(if self.truth.motors.is_empty() { servo } else { servo.with_motors(self.truth.motors.clone()) })
    }
}
