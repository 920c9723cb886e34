//! The simulated arms: which there are, and how one is put together from a robot, its truth and its servo.

use armid::dynamics::{Dynamics, States};
use armid::experiment::{
    ActualArm, Arm, ArmError, Effects, Ending, ExperimentPlan, Flow, Phase, Plant, RawSample, Recording, Sensing,
    Servo, Sink, record,
};
use armid::model::{Robot, StandardParameters};
use armid::seed::RunNoise;
use armid::study::{Performed, Truth, exact_states};
use armid_io::LoadedRobot;
use armid_sim::{AnalyticPlant, BatchRun, Engine, record_runs};
use miette::Result;

use super::ArmKind;

/// A robot that can be simulated: its model, its nominal parameters and its true ones.
#[derive(Clone, Debug)]
pub(crate) struct Simulation {
    pub(crate) loaded: LoadedRobot,
    pub(crate) nominal: StandardParameters,
    pub(crate) truth: Truth,
    pub(crate) arm: ArmKind,
    /// Effects beside those of the truth.
    effects: Effects,
}

impl Simulation {
    /// Adds the truth to a robot, and a servo's guess: the nominal parameters, or the truth where there are none.
    pub(crate) fn of(loaded: LoadedRobot, arm: ArmKind) -> Result<Self> {
        let truth = loaded.truth()?;
        let nominal = loaded.nominal.clone().unwrap_or_else(|| truth.parameters.clone());
        Ok(Self { loaded, nominal, truth, arm, effects: Effects::none() })
    }

    /// The same arm with these effects beside those of its truth; they count where both have one.
    pub(crate) fn with_effects(self, effects: Effects) -> Self {
        Self { effects, ..self }
    }

    /// The same robot with other true parameters.
    pub(crate) fn made_of(&self, truth: &Truth) -> Self {
        Self { truth: truth.clone(), ..self.clone() }
    }

    pub(crate) fn robot(&self) -> &Robot {
        &self.loaded.robot
    }

    /// The arm for one run, with these sensors.
    pub(crate) fn arm(&self, sensing: &Sensing, noise: RunNoise) -> Result<Box<dyn Arm>, String> {
        Ok(Box::new(self.servo(sensing)?.with_noise(noise)))
    }

    /// Exact states of one recorded period of the closed loop with noise-free sensors, about 500 of them; of the arm
    /// without effects, which the true parameters describe.
    pub(crate) fn exact_period(&self, plan: &ExperimentPlan) -> Result<States, String> {
        let mut servo = self.servo_of(&Effects::none(), &Sensing::ideal())?;
        let plan = plan.clone().with_periods(1);
        let period = plan.layout().map_err(|fault| fault.to_string())?.period_samples;
        let stride = (1..=period / 500).rev().find(|stride| period % stride == 0).unwrap_or(1);
        let (mut q, mut qd, mut tau) = (Vec::new(), Vec::new(), Vec::new());
        let ending = servo
            .perform_observed(&plan, &mut Discarding, &mut |state| {
                if state.phase == Phase::Record && state.index % stride == 0 {
                    q.extend_from_slice(state.q);
                    qd.extend_from_slice(state.qd);
                    tau.extend_from_slice(state.tau);
                }
            })
            .map_err(|fault: ArmError| fault.to_string())?;
        if let Ending::Diverged { t, reason, .. } = ending {
            return Err(format!("the noise-free motion diverged at t = {t:.3} s: {reason}"));
        }
        Ok(exact_states(&mut Dynamics::new(self.robot(), &self.truth.parameters), &q, &qd, &tau))
    }

    /// The plant without effects, for callers that bring their own servo.
    pub(crate) fn plant(&self) -> Result<Box<dyn Plant>, String> {
        self.plant_of(&ActualArm::new(&Effects::none(), self.robot(), &self.truth.parameters))
    }

    /// The plant of an arm.
    fn plant_of(&self, actual: &ActualArm) -> Result<Box<dyn Plant>, String> {
        match self.arm {
            ArmKind::Simulated(engine) => {
                engine.plant(actual.robot(), actual.parameters()).map_err(|fault| fault.to_string())
            }
            ArmKind::Replay => Err("arm replay is a recording, expected a simulated arm".to_owned()),
            ArmKind::Ros2 => Err("arm ros2 is a real arm, expected a simulated one".to_owned()),
        }
    }

    /// The plant with the controller and the sensors of the real arm around it.
    pub(crate) fn servo(&self, sensing: &Sensing) -> Result<Servo<Box<dyn Plant>>, String> {
        self.servo_of(&self.truth.effects.and(&self.effects), sensing)
    }

    /// What came of every run, each with the bits that it would have alone. Where the engine has lanes the runs are computed
    /// side by side.
    pub(crate) fn record_all(&self, runs: &[BatchRun<'_>]) -> Result<Vec<Performed>, String> {
        let sensing = Sensing::default();
        if self.arm == ArmKind::Simulated(Engine::Analytic) {
            let actual = ActualArm::new(&self.truth.effects.and(&self.effects), self.robot(), &self.truth.parameters);
            let plant = AnalyticPlant::new(actual.robot(), actual.parameters()).map_err(|fault| fault.to_string())?;
            return Ok(record_runs(&self.servo_around(plant, actual, &sensing)?, runs));
        }
        runs.iter().map(|run| Ok(record(&mut *self.arm(&sensing, run.noise)?, run.plan))).collect()
    }

    fn servo_of(&self, effects: &Effects, sensing: &Sensing) -> Result<Servo<Box<dyn Plant>>, String> {
        let actual = ActualArm::new(effects, self.robot(), &self.truth.parameters);
        let plant = self.plant_of(&actual)?;
        self.servo_around(plant, actual, sensing)
    }

    fn servo_around<P: Plant>(&self, plant: P, actual: ActualArm, sensing: &Sensing) -> Result<Servo<P>, String> {
        let servo = Servo::new(self.robot(), &self.nominal, plant).map_err(|fault| fault.to_string())?;
        let servo = servo.with_sensing(sensing.clone()).with_effects(actual);
        let servo = servo.with_robot_text(self.loaded.text.content.as_ref());
        Ok(if self.truth.motors.is_empty() { servo } else { servo.with_motors(self.truth.motors.clone()) })
    }
}

/// A sink for a run of which only the true states matter.
struct Discarding;

impl Sink for Discarding {
    fn begin(&mut self, _: &Recording) {}

    fn sample(&mut self, _: &RawSample<'_>) -> Flow {
        Flow::Continue
    }
}
