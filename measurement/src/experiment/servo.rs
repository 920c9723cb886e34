//! A plant with the controller and the sensors of a real arm around it.

use std::sync::Arc;

use super::arm::{Arm, ArmError, Ending, Sink};
use super::command_table::CommandTable;
use super::cycle::{Cycle, Next, Timing, TrueState};
use super::effects::ActualArm;
use super::joint_loop::JointLoop;
use super::motor_load::MotorLoad;
use super::motors::Motors;
use super::plan::ExperimentPlan;
use super::plant::Plant;
use super::recording::Recording;
use super::sensing::{Sensing, Sensors};
use super::servo_error::ServoError;
use super::tracking::Tracking;
use crate::model::{Drive, Robot, StandardParameters};
use crate::seed::{RunNoise, Seed};

/// A simulated arm: a plant under the robot's joint servo, seen through the robot's sensors.
///
/// Each servo step reads the encoders, lets the controller decide motor currents, and holds the torques of these
/// currents on the plant until the next step. Gains come from the nominal parameters at
/// [`super::gain_pose`]; the controller never sees the plant's own.
///
/// A run is a pure function of robot, plant, plan, sensing, seed and run number.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::chains::planar_2r;
/// use armid::trajectory::{FourierJoint, FourierTrajectory};
/// use armid::experiment::{ExperimentPlan, Plant, PlantError, Servo, record};
/// use armid::model::StandardParameters;
/// use armid::model::term::ROTOR;
/// use armid::seed::Seed;
/// /// Two flywheels of 2 kg·m².
/// struct FlyWheels([f64; 2], [f64; 2]);
/// impl Plant for FlyWheels {
///     fn dof(&self) -> usize { 2 }
///     fn state(&self) -> (&[f64], &[f64]) { (&self.0, &self.1) }
///     fn reset(&mut self, q: &[f64], qd: &[f64]) {
///         self.0.copy_from_slice(q);
///         self.1.copy_from_slice(qd);
///     }
///     fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
///         for i in 0..2 {
///             self.1[i] += dt * tau[i] / 2.0;
///             self.0[i] += dt * self.1[i];
///         }
///         Ok(())
///     }
/// }
/// let robot = planar_2r();
/// let mut nominal = StandardParameters::zero(2);
/// nominal.drives.iter_mut().for_each(|drive| drive[ROTOR] = 2.0);
/// let series = |name: &str| FourierJoint { name: name.into(), a: vec![0.4], b: vec![0.1], q0: 0.3 };
/// let trajectory = FourierTrajectory { period_s: 2.0, joints: vec![series("shoulder"), series("elbow")] };
/// let plan = ExperimentPlan::new(trajectory).with_periods(2);
/// let mut servo = Servo::new(&robot, &nominal, FlyWheels([0.0; 2], [0.0; 2])).unwrap().with_seed(Seed::new(1), 0);
/// let (recording, ending) = record(&mut servo, &plan).unwrap();
/// assert!(ending.is_complete() && recording.periods() == 2);
/// assert!(servo.tracking().unwrap().peak_error[0] < 2e-3);
/// ```
#[derive(Clone, Debug)]
pub struct Servo<P> {
    robot: Robot,
    robot_text: String,
    plant: P,
    sensing: Sensing,
    noise: RunNoise,
    load: MotorLoad,
    motors: Vec<Drive>,
    actual: Option<ActualArm>,
    tracking: Option<Tracking>,
}

impl<P: Plant> Servo<P> {
    /// A servo around a plant, with gains for the nominal parameters, the sensors of the robot file, seed 0 and run 0.
    ///
    /// # Errors
    /// [`ServoError`] where plant or parameters do not fit the robot, or give a motor no inertia.
    pub fn new(robot: &Robot, nominal: &StandardParameters, plant: P) -> Result<Self, ServoError> {
        let (found, expected) = (plant.dof(), robot.dof());
        if found != expected {
            return Err(ServoError::Dof { quantity: "plant", found, expected });
        }
        let load = MotorLoad::new(robot, nominal)?;
        Ok(Self {
            robot: robot.clone(),
            robot_text: String::new(),
            plant,
            sensing: Sensing::default(),
            noise: Seed::new(0).of_run(0),
            load,
            motors: robot.joints().iter().map(|joint| joint.drive.clone()).collect(),
            actual: None,
            tracking: None,
        })
    }

    /// Returns this servo with the random streams of another seed and run.
    #[must_use]
    pub fn with_seed(self, seed: Seed, run: u64) -> Self {
        self.with_noise(seed.of_run(run))
    }

    /// Returns this servo with the random numbers of a run.
    #[must_use]
    pub fn with_noise(mut self, noise: RunNoise) -> Self {
        self.noise = noise;
        self
    }

    /// Returns this servo with other sensors.
    #[must_use]
    pub fn with_sensing(mut self, sensing: Sensing) -> Self {
        self.sensing = sensing;
        self
    }

    /// Returns this servo around motors that are not what the robot file says: `motors` holds the torque constants and
    /// circuits that the arm really has, n; the controller goes on with those of the robot file.
    ///
    /// # Panics
    /// If there is not one motor for each joint.
    #[must_use]
    pub fn with_motors(mut self, motors: Vec<Drive>) -> Self {
        assert_eq!(motors.len(), self.robot.dof(), "one motor for each joint");
        self.motors = motors;
        self
    }

    /// Returns this servo on an arm with effects. The plant must be one of [`ActualArm::robot`] and
    /// [`ActualArm::parameters`]; controller and transmission stay those of the robot file.
    ///
    /// # Panics
    /// If the arm has another number of joints.
    #[must_use]
    pub fn with_effects(mut self, actual: ActualArm) -> Self {
        assert_eq!(actual.robot().dof(), self.robot.dof(), "an arm of as many joints as the robot");
        self.actual = (!actual.is_plain()).then_some(actual);
        self
    }

    /// Returns this servo; its recordings carry the text of the robot file.
    #[must_use]
    pub fn with_robot_text(mut self, text: impl Into<String>) -> Self {
        self.robot_text = text.into();
        self
    }

    /// The plant.
    pub fn plant(&self) -> &P {
        &self.plant
    }

    /// How well the last experiment followed its command.
    pub fn tracking(&self) -> Option<&Tracking> {
        self.tracking.as_ref()
    }

    /// What a recording of this plan with this seed is, before its first sample.
    ///
    /// # Errors
    /// [`ArmError::Plan`] where the plan cannot be performed.
    pub fn recording(&self, plan: &ExperimentPlan, seed: Seed) -> Result<Recording, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        Ok(Recording::empty(&self.robot, &self.robot_text, plan, &layout, Some(seed)))
    }

    /// The servo's part of an experiment for each run, for callers that step the plants themselves.
    ///
    /// # Errors
    /// [`ArmError`] where the plan cannot be performed.
    pub fn cycles(&self, plan: &ExperimentPlan, runs: &[RunNoise]) -> Result<Vec<Cycle>, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        let tuning = self.robot.servo();
        let ratio = tuning.rate_hz / plan.rate_hz;
        if ratio < 0.5 || (ratio - ratio.round()).abs() > 1e-9 * ratio {
            return Err(ArmError::Rate { servo_hz: tuning.rate_hz, rate_hz: plan.rate_hz });
        }
        let per_sample = ratio.round() as usize;
        let table = Arc::new(CommandTable::new(plan, &layout, per_sample));
        let timing = Timing { layout: Arc::new(layout), table, rate_hz: plan.rate_hz, per_sample };
        let actual = self.actual.as_ref();
        let actual_sensors = actual.map(|actual| actual.sensors(plan.rate_hz));
        let motors = Motors::new(&self.motors, tuning.rate_hz);
        let cycle = |&run: &RunNoise| {
            let sensors = Sensors::new(&self.robot, &self.sensing, run);
            let sensors = match &actual_sensors {
                None => sensors,
                Some(actual) => sensors.with_effects(actual),
            };
            let joints = JointLoop::of(&self.robot, &self.load, motors.clone(), sensors);
            let Some(actual) = actual else { return Cycle::new(&self.robot, timing.clone(), joints, None, None) };
            let joints = joints.with_effects(actual, timing.table.row(0));
            let (clock, slips) = (actual.clock(run), actual.clock_slips(plan.rate_hz, run));
            Cycle::new(&self.robot, timing.clone(), joints, clock, slips)
        };
        Ok(runs.iter().map(cycle).collect())
    }

    /// The servo's part of one experiment with this servo's own seed and run.
    ///
    /// # Errors
    /// [`ArmError`] where the plan cannot be performed.
    pub fn cycle(&self, plan: &ExperimentPlan) -> Result<Cycle, ArmError> {
        let mut cycles = self.cycles(plan, &[self.noise])?;
        Ok(cycles.pop().expect("one cycle for one run"))
    }

    /// Performs a plan and shows an observer the plant's true state at every sample, before the sink gets what the
    /// sensors made of it.
    ///
    /// # Errors
    /// [`ArmError`] where the experiment cannot begin.
    pub fn perform_observed(
        &mut self,
        plan: &ExperimentPlan,
        sink: &mut dyn Sink,
        observer: &mut dyn FnMut(&TrueState<'_>),
    ) -> Result<Ending, ArmError> {
        let mut cycle = self.cycle(plan)?;
        sink.begin(&self.recording(plan, self.noise.seed)?);
        self.plant.reset(cycle.start(), &vec![0.0; self.robot.dof()]);
        let parts = cycle.parts();
        let dt = cycle.dt() / parts as f64;
        let ending = 'experiment: loop {
            let (q, qd) = self.plant.state();
            if let Next::End(ending) = cycle.advance(q, qd, sink, observer) {
                break ending;
            }
            for _ in 0..parts {
                let (q, qd) = self.plant.state();
                cycle.push(q, qd);
                if let Err(fault) = self.plant.step(cycle.tau(), dt) {
                    break 'experiment cycle.fail(fault);
                }
            }
        };
        self.tracking = Some(cycle.tracking().clone());
        Ok(ending)
    }
}

impl<P: Plant> Arm for Servo<P> {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        self.perform_observed(plan, sink, &mut |_| {})
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{Discarding, record};
    use crate::model::{EffortInterface, ServoTuning};

    fn plan(dof: usize) -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.2, ramp_s: 0.5, periods: 3, ..ExperimentPlan::new(hinges::trajectory(dof)) }
    }

    fn servo(robot: &Robot) -> Servo<FlyWheels> {
        Servo::new(robot, &hinges::parameters(robot.dof()), FlyWheels::new(robot.dof())).unwrap()
    }

    #[test]
    fn analytic_gains_sit_on_the_rotor() {
        let servo = servo(&hinges::single());
        assert!((servo.load.inertia[0] - hinges::INERTIA).abs() < 1e-15);
    }

    #[test]
    fn identity_ideal_samples_are_the_true_state() {
        // Without sensors' faults q̂ = q, and the current is half of the torques held before and after the sample.
        for robot in [hinges::single(), hinges::coupled()] {
            let n = robot.dof();
            let mut servo = servo(&robot).with_sensing(Sensing::ideal());
            let robot = robot.with_spec(|spec| spec.effort = EffortInterface::Torque).unwrap();
            let mut servo_torque = Servo { robot: robot.clone(), ..servo.clone() };
            let (mut q, mut tau) = (Vec::new(), Vec::new());
            let mut recording = record(&mut servo_torque, &plan(n)).unwrap().0;
            assert_eq!(recording.effort_unit, EffortInterface::Torque);
            servo
                .perform_observed(&plan(n), &mut Discarding, &mut |state| {
                    q.extend_from_slice(state.q);
                    tau.extend_from_slice(state.tau);
                })
                .unwrap();
            for (x, y) in recording.q.iter().zip(&q) {
                assert!((x - y).abs() < 1e-14);
            }
            for k in n..tau.len() {
                assert!((recording.effort[k] - 0.5 * (tau[k] + tau[k - n])).abs() < 1e-12);
            }
            recording.effort.clear();
        }
    }

    #[test]
    fn analytic_flywheels_follow_within_the_documented_error() {
        let robot = hinges::coupled();
        let mut servo = servo(&robot).with_seed(Seed::new(4), 2);
        let (recording, ending) = record(&mut servo, &plan(2)).unwrap();
        assert!(ending.is_complete());
        assert_eq!(recording.len(), plan(2).layout().unwrap().samples());
        assert_eq!(recording.periods(), 3);
        let tracking = servo.tracking().unwrap();
        // The nominal inertia behind the coupling is 4 and 2 kg·m² on the motors; accelerations stay below 6 rad/s²,
        // so the error stays below q̈/ω² = 6/50² times a few for the coupling.
        assert!(tracking.peak_error.iter().all(|&e| e < 6e-3), "{tracking:?}");
        assert_eq!(tracking.saturated_steps, 0);
        assert_eq!(tracking.steps, 6000);
    }

    #[test]
    fn identity_equal_seed_equal_bits_and_other_runs_differ() {
        let robot = hinges::coupled();
        let run = |seed, run| {
            let mut servo = servo(&robot).with_seed(Seed::new(seed), run);
            let first = record(&mut servo, &plan(2)).unwrap().0;
            assert_eq!(record(&mut servo, &plan(2)).unwrap().0, first, "the second experiment of one servo");
            first
        };
        let base = run(1, 0);
        assert_eq!(run(1, 0), base);
        for other in [run(1, 1), run(2, 0)] {
            assert_ne!(other.effort, base.effort);
            assert_ne!(other.q, base.q);
        }
    }

    #[test]
    fn rates_that_do_not_divide_are_refused_and_faster_servos_sample_every_so_often() {
        let robot = hinges::single();
        let tuned = |rate_hz| {
            let tuning = ServoTuning { rate_hz, ..ServoTuning::ASSUMED };
            servo(&robot.clone().with_spec(|spec| spec.servo = Some(tuning)).unwrap())
        };
        let slow = tuned(1500.0);
        assert!(matches!(slow.cycle(&plan(1)), Err(ArmError::Rate { .. })));
        let mut fast = tuned(5000.0).with_sensing(Sensing::ideal());
        let (recording, ending) = record(&mut fast, &plan(1)).unwrap();
        assert!(ending.is_complete());
        assert_eq!(recording.len(), plan(1).layout().unwrap().samples());
        assert_eq!(fast.tracking().unwrap().steps, 3 * 2000 * 5);
    }
}
