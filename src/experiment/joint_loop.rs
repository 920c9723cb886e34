//! The servo of all joints between two steps of a plant, for callers that bring their own commands: encoders, controller,
//! current limit, transmission, ammeters. No plan inside, and no plant.
//!
//! A [`super::Servo`] performs a plan; a robot controller follows any command. Both close the same loop.

use super::controller::gain_pose;
use super::motors::Motors;
use super::sensing::Sensors;
use super::{JointPid, Sensing, ServoError, Transmission};
use crate::dynamics::Dynamics;
use crate::model::{Drive, EffortInterface, Robot, StandardParameters};
use crate::seed::Seed;

/// Encoders, controllers and motors of all joints, one servo step at a time.
///
/// ```
/// use armid::conformance::chains::planar_2r;
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
    effort: EffortInterface,
    transmission: Transmission,
    motors: Motors,
    controller: JointPid,
    sensors: Sensors,
    fresh: bool,
    q_motor: Vec<f64>,
    qd_motor: Vec<f64>,
    command_motor: Vec<f64>,
    measured: Vec<f64>,
    before: Vec<f64>,
    current: Vec<f64>,
    torque_motor: Vec<f64>,
    tau: Vec<f64>,
    sensed: Vec<f64>,
    q: Vec<f64>,
    reported: Vec<f64>,
}

fn drives(robot: &Robot) -> Vec<Drive> {
    robot.joints().iter().map(|joint| joint.drive.clone()).collect()
}

/// Inertia that each motor sees at the gain pose, kg·m²; what the controller's gains are placed on.
///
/// # Errors
/// [`ServoError`] where the nominal parameters are of another robot, or give a motor no inertia.
pub(super) fn motor_inertia(robot: &Robot, nominal: &StandardParameters) -> Result<Vec<f64>, ServoError> {
    let (found, expected) = (nominal.links.len(), robot.dof());
    if found != expected {
        return Err(ServoError::Dof { quantity: "nominal parameter set", found, expected });
    }
    let mass_matrix = Dynamics::new(robot, nominal).mass_matrix(&gain_pose(robot));
    let inertia = Transmission::new(robot).motor_inertia(&mass_matrix);
    for (joint, &inertia) in robot.joints().iter().zip(&inertia) {
        if !(inertia.is_finite() && inertia > 0.0) {
            return Err(ServoError::Inertia { joint: joint.name.clone(), inertia });
        }
    }
    Ok(inertia)
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
        let inertia = motor_inertia(robot, nominal)?;
        let transmission = Transmission::new(robot);
        let limit: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.current_limit).collect();
        let controller = JointPid::new(robot.servo(), &inertia, transmission.per_ampere(), &limit);
        let zero = || vec![0.0; robot.dof()];
        Ok(Self {
            effort: robot.effort(),
            motors: Motors::new(&drives(robot), robot.servo().rate_hz),
            sensors: Sensors::new(robot, sensing, seed, run),
            transmission,
            controller,
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
        })
    }

    /// The same loop around motors that are not what the robot file says, as [`super::Servo::with_motors`].
    #[must_use]
    pub fn with_motors(mut self, motors: &[Drive]) -> Self {
        self.motors = Motors::new(motors, 1.0 / self.controller.dt());
        self
    }

    /// Length of a servo step, s.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.controller.dt()
    }

    /// Forgets the past of the controller: before the motors are switched on again.
    pub fn reset(&mut self) {
        self.controller.reset();
        self.fresh = true;
    }

    /// One servo step: reads the encoders of an arm at `q` that moves with `qd` and decides [`JointLoop::tau`] for
    /// `command`, all in joint coordinates, n. Returns whether a current is at its limit; the speed matters only where
    /// the supply is that limit.
    pub fn step(&mut self, command: &[f64], q: &[f64], qd: &[f64]) -> bool {
        self.transmission.motor_motion(qd, &mut self.qd_motor);
        self.transmission.motor_motion(q, &mut self.q_motor);
        self.transmission.motor_motion(command, &mut self.command_motor);
        self.sensors.positions(&self.q_motor, &mut self.measured);
        self.before.copy_from_slice(&self.current);
        let mut saturated = self.controller.step(&self.command_motor, &self.measured, &mut self.current);
        saturated |= self.motors.saturate(&self.qd_motor, &mut self.current);
        if std::mem::take(&mut self.fresh) {
            self.before.copy_from_slice(&self.current);
        }
        for i in 0..self.tau.len() {
            self.torque_motor[i] = self.motors.per_ampere()[i] * self.current[i];
        }
        self.transmission.joint_torque(&self.torque_motor, &mut self.tau);
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
    #[must_use]
    pub fn tau(&self) -> &[f64] {
        &self.tau
    }

    /// Commanded motor currents until the next step, A; n.
    #[must_use]
    pub fn current(&self) -> &[f64] {
        &self.current
    }

    /// What the sensors say at this step, as the robot reports it: joint coordinates, rad (m), and effort in its unit;
    /// n each.
    pub fn sense(&mut self) -> (&[f64], &[f64]) {
        self.transmission.joint_motion(&self.measured, &mut self.q);
        self.sensors.currents(&self.before, &self.current, &mut self.sensed);
        match self.effort {
            EffortInterface::Current => self.reported.copy_from_slice(&self.sensed),
            EffortInterface::Torque => {
                for i in 0..self.sensed.len() {
                    self.torque_motor[i] = self.transmission.per_ampere()[i] * self.sensed[i];
                }
                self.transmission.joint_torque(&self.torque_motor, &mut self.reported);
            }
        }
        (&self.q, &self.reported)
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
            let robot = hinges::coupled().with_effort(effort);
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
