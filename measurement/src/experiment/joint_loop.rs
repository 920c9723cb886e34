//! The servo of all joints between two steps of a plant: encoders, controller, current limit, transmission, ammeters. No plan
//! inside, and no plant.
//!
//! The one loop of the project: a [`super::Cycle`] closes it along a plan, with the effects of an arm where it has some; a
//! robot controller closes it around any command.

use super::controller::JointPid;
use super::effects::{ActualArm, ActualDrives};
use super::motor_load::MotorLoad;
use super::motors::Motors;
use super::sensing::{Sensing, Sensors};
use super::servo_error::ServoError;
use super::transmission::Transmission;
use crate::model::{Drive, EffortInterface, Robot, StandardParameters};
use crate::seed::Seed;

/// Encoders, controllers and motors of all joints, one servo step at a time.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::chains::planar_2r;
/// use armid::experiment::{JointLoop, Sensing};
/// use armid::model::StandardParameters;
/// use armid::model::term::ROTOR;
/// use armid::seed::Seed;
/// let robot = planar_2r();
/// let mut nominal = StandardParameters::zero(2);
/// nominal.drives.iter_mut().for_each(|drive| drive[ROTOR] = 2.0);
/// let mut joints = JointLoop::new(&robot, &nominal, &Sensing::ideal(), Seed::new(1), 0)?;
/// joints.step(&[0.1, 0.0], &[0.0, 0.0], &[0.0, 0.0]);
/// assert!(joints.tau()[0] > 0.0 && joints.tau()[1] == 0.0);
/// # Ok::<(), armid::experiment::ServoError>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointLoop {
    pub(super) effort: EffortInterface,
    pub(super) transmission: Transmission,
    pub(super) motors: Motors,
    pub(super) controller: JointPid,
    pub(super) sensors: Sensors,
    /// What the arm's drives make of set points; `None` where they exert the commanded torque.
    drives: Option<Box<ActualDrives>>,
    /// Whether no current has been held since the motors were switched on.
    fresh: bool,
    q_motor: Vec<f64>,
    pub(super) qd_motor: Vec<f64>,
    command_motor: Vec<f64>,
    measured: Vec<f64>,
    before: Vec<f64>,
    pub(super) current: Vec<f64>,
    torque_motor: Vec<f64>,
    tau: Vec<f64>,
    sensed: Vec<f64>,
    q: Vec<f64>,
    reported: Vec<f64>,
    voltage: Vec<f64>,
    /// Coordinates and velocities of the links at the last step, and what their encoders say of them.
    links: [Vec<f64>; 2],
    link_q: Vec<f64>,
}

fn drives(robot: &Robot) -> Vec<Drive> {
    robot.joints().iter().map(|joint| joint.drive.clone()).collect()
}

impl JointLoop {
    /// The loop of a robot with gains for its nominal parameters, and sensors of one seed and run.
    ///
    /// # Errors
    /// [`ServoError`] where the parameters are of another robot, or give a motor no inertia.
    pub fn new(
        robot: &Robot,
        nominal: &StandardParameters,
        sensing: &Sensing,
        seed: Seed,
        run: u64,
    ) -> Result<Self, ServoError> {
        let load = MotorLoad::new(robot, nominal)?;
        let motors = Motors::new(&drives(robot), robot.servo().rate_hz);
        Ok(Self::of(robot, &load, motors, Sensors::new(robot, sensing, seed.of_run(run))))
    }

    /// The loop with gains for motors that turn this load.
    pub(super) fn of(robot: &Robot, load: &MotorLoad, motors: Motors, sensors: Sensors) -> Self {
        let transmission = Transmission::new(robot);
        let limit: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.current_limit).collect();
        let controller = JointPid::new(robot.servo(), load, &transmission.per_ampere, &limit);
        let zero = || vec![0.0; robot.dof()];
        Self {
            effort: robot.effort(),
            motors,
            sensors,
            transmission,
            controller,
            drives: None,
            fresh: true,
            q_motor: zero(),
            qd_motor: zero(),
            command_motor: zero(),
            measured: zero(),
            before: zero(),
            current: zero(),
            torque_motor: zero(),
            tau: zero(),
            sensed: zero(),
            q: zero(),
            reported: zero(),
            voltage: zero(),
            links: [zero(), zero()],
            link_q: zero(),
        }
    }

    /// Returns this loop around the drives of an arm with effects, whose plant is at rest at `start`.
    pub(super) fn with_effects(mut self, arm: &ActualArm, start: &[f64]) -> Self {
        self.drives = ActualDrives::of(arm, &self.transmission, &self.motors.per_ampere, start).map(Box::new);
        self
    }

    /// Returns this loop around motors that are not what the robot file says, as [`super::Servo::with_motors`].
    #[must_use]
    pub fn with_motors(mut self, motors: &[Drive]) -> Self {
        self.motors = Motors::new(motors, 1.0 / self.controller.dt());
        self
    }

    /// Whether each motor turns its own joint and has no effects, so that runs can stand side by side.
    pub(super) fn is_plain(&self) -> bool {
        self.transmission.forward.is_none() && self.drives.is_none() && self.sensors.plain().is_some()
    }

    /// Length of a servo step, s.
    pub fn dt(&self) -> f64 {
        self.controller.dt()
    }

    /// Resets the state of the controller: before the motors are switched on again.
    pub fn reset(&mut self) {
        self.controller.reset();
        self.fresh = true;
    }

    /// What the servo remembers from step to step, in motor coordinates: last errors (rad), their filtered rates (rad/s) and
    /// integrals (N·m), 3n.
    pub fn memory(&self) -> Vec<f64> {
        self.controller.memory()
    }

    /// Continues with this memory (3n), as if the servo had come to it.
    ///
    /// # Panics
    /// If it is of another number of joints.
    pub fn recall(&mut self, memory: &[f64]) {
        assert_eq!(memory.len(), 3 * self.tau.len(), "three numbers for each motor");
        self.controller.recall(memory);
        self.fresh = true;
    }

    /// Adds to the integrals so much of joint torque, N·m (N); n.
    pub fn add_torque(&mut self, joint_torque: &[f64]) {
        self.transmission.motor_torque(joint_torque, &mut self.torque_motor);
        self.controller.add_to_integrals(&self.torque_motor);
    }

    /// Steps of the plant in a servo step, of equal length: one, unless effects of the drives need more.
    pub(super) fn parts(&self) -> usize {
        self.drives.as_ref().map_or(1, |drives| drives.parts)
    }

    /// Decides [`JointLoop::tau`] for the next of [`JointLoop::parts`] steps of the plant, which is at `q`, `qd`. Without
    /// effects of the drives it stays what the servo step decided.
    pub(super) fn push(&mut self, q: &[f64], qd: &[f64]) {
        if let Some(drives) = &mut self.drives {
            drives.push(q, qd, &mut self.tau);
        }
    }

    /// One servo step: reads the encoders of an arm at `q` that moves with `qd` and decides [`JointLoop::tau`] for
    /// `command`, all in joint coordinates, n. Returns whether a current is at its limit; the speed matters only where
    /// the supply is that limit.
    pub fn step(&mut self, command: &[f64], q: &[f64], qd: &[f64]) -> bool {
        self.transmission.motor_motion(q, &mut self.q_motor);
        self.transmission.motor_motion(qd, &mut self.qd_motor);
        let command = self.transmission.motor_view(command, &mut self.command_motor);
        if self.sensors.has_links() {
            self.links[0].copy_from_slice(q);
            self.links[1].copy_from_slice(qd);
        }
        if let Some(drives) = &self.drives {
            drives.positions(&mut self.q_motor);
            drives.speeds(&mut self.qd_motor);
        }
        self.sensors.positions(&self.q_motor, &mut self.measured);
        std::mem::swap(&mut self.before, &mut self.current);
        let mut saturated = self.controller.step(command, &self.measured, &mut self.current);
        saturated |= self.motors.saturate(&self.qd_motor, &mut self.current);
        if std::mem::take(&mut self.fresh) {
            self.before.copy_from_slice(&self.current);
        }
        let is_direct = self.transmission.forward.is_none();
        let torque = if is_direct { &mut self.tau } else { &mut self.torque_motor };
        for ((torque, per_ampere), current) in torque.iter_mut().zip(&self.motors.per_ampere).zip(&self.current) {
            *torque = per_ampere * current;
        }
        if !is_direct {
            self.transmission.joint_torque(&self.torque_motor, &mut self.tau);
        }
        if let Some(drives) = &mut self.drives {
            drives.set(&self.current);
        }
        saturated
    }

    /// A step with the motors off: the encoders are read, no current flows.
    pub fn rest(&mut self, q: &[f64]) {
        self.reset();
        self.transmission.motor_motion(q, &mut self.q_motor);
        self.sensors.positions(&self.q_motor, &mut self.measured);
        for values in [&mut self.before, &mut self.current, &mut self.tau] {
            values.fill(0.0);
        }
    }

    /// What the motors exert on the joints until the next step, N·m (N); n.
    pub fn tau(&self) -> &[f64] {
        &self.tau
    }

    /// Commanded motor currents until the next step, A; n.
    pub fn current(&self) -> &[f64] {
        &self.current
    }

    /// What the sensors say at this step, as the robot reports it: joint coordinates, rad (m), and effort in its unit;
    /// n each.
    pub fn sense(&mut self) -> (&[f64], &[f64]) {
        self.sense_late(0.0, false);
        (&self.q, &self.reported)
    }

    /// Reports the sample `late_s` seconds after the step, or not at all where the sample is `lost`: [`JointLoop::reported`] then
    /// stays that of the one before.
    pub(super) fn sense_late(&mut self, late_s: f64, lost: bool) {
        self.sensors.late = late_s / self.controller.dt();
        if late_s != 0.0 {
            for (q, qd) in self.q_motor.iter_mut().zip(&self.qd_motor) {
                *q += late_s * qd;
            }
            self.sensors.positions(&self.q_motor, &mut self.measured);
        }
        let is_reported = self.effort == EffortInterface::Current && !lost;
        let sensed = if is_reported { &mut self.reported } else { &mut self.sensed };
        self.sensors.currents(&self.before, &self.current, sensed);
        if lost {
            return;
        }
        self.transmission.joint_motion(&self.measured, &mut self.q);
        if self.effort == EffortInterface::Torque {
            for i in 0..self.sensed.len() {
                self.torque_motor[i] = self.transmission.per_ampere[i] * self.sensed[i];
            }
            self.transmission.joint_torque(&self.torque_motor, &mut self.reported);
        }
        if self.sensors.has_links() {
            let [q, qd] = &self.links;
            let at: Vec<f64> = q.iter().zip(qd).map(|(q, qd)| q + late_s * qd).collect();
            self.sensors.links(&at, &mut self.link_q);
        }
        if self.sensors.has_voltage() {
            self.motors.voltages(&self.before, &self.current, &self.qd_motor, &mut self.voltage);
            self.sensors.voltages(&mut self.voltage);
        }
    }

    /// The last sample: positions, rad (m), efforts in the robot's unit, and where they are reported voltages, V, and positions of the
    /// links, rad (m); n each.
    pub(super) fn reported(&self) -> [&[f64]; 4] {
        let voltage = if self.sensors.has_voltage() { &self.voltage[..] } else { &[] };
        let link_q = if self.sensors.has_links() { &self.link_q[..] } else { &[] };
        [&self.q, &self.reported, voltage, link_q]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{CommandTable, ExperimentPlan, Plant, Servo, record};
    use crate::model::EffortInterface;

    #[test]
    fn identity_following_a_plan_s_commands_is_the_servo_to_the_last_bit() {
        for effort in EffortInterface::ALL {
            let robot = hinges::coupled().with_spec(|spec| spec.effort = effort).unwrap();
            let nominal = hinges::parameters(2);
            let plan =
                ExperimentPlan { settle_s: 0.1, ramp_s: 0.3, periods: 1, ..ExperimentPlan::new(hinges::trajectory(2)) };
            let (seed, run) = (Seed::new(5), 3);
            let mut servo = Servo::new(&robot, &nominal, FlyWheels::new(2)).unwrap().with_seed(seed, run);
            let expected = record(&mut servo, &plan).unwrap().0;

            let mut joints = JointLoop::new(&robot, &nominal, &Sensing::default(), seed, run).unwrap();
            let layout = plan.layout().unwrap();
            let table = CommandTable::new(&plan, &layout, 1);
            let mut plant = FlyWheels::new(2);
            plant.reset(table.row(0), &[0.0; 2]);
            for k in 0..layout.samples() {
                let (q, qd) = plant.state();
                joints.step(table.row(k), q, qd);
                let (q, effort) = joints.sense();
                assert_eq!((q, effort), (expected.q(k), expected.effort(k)), "sample {k}");
                let tau = joints.tau().to_vec();
                plant.step(&tau, joints.dt()).unwrap();
            }
        }
    }

    #[test]
    fn motors_that_rest_draw_nothing_and_start_again_without_a_kick() {
        let robot = hinges::single();
        let mut joints = JointLoop::new(&robot, &hinges::parameters(1), &Sensing::ideal(), Seed::new(1), 0).unwrap();
        joints.step(&[1.0], &[0.0], &[0.0]);
        assert!(joints.current()[0] > 0.0);
        joints.rest(&[0.3]);
        assert_eq!(joints.sense().0, [0.3]);
        assert_eq!((joints.current(), joints.tau()), (&[0.0][..], &[0.0][..]));
        joints.step(&[0.3], &[0.3], &[0.0]);
        assert_eq!(joints.current(), [0.0]);
    }
}
