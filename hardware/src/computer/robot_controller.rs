//! The robot controller between two moments of the wall clock: one servo step after another.

use armid::experiment::{JointLoop, Plant, PlantError, Sensing, ServoError};
use armid::model::{Drive, Robot, StandardParameters};
use armid::seed::Seed;

use super::output::Output;
use super::reporter::Reporter;
use super::{Commander, Fault, FaultKind, JointLimits, Replacement, Spline, Watchdog};
use crate::message::Time;

/// Largest distance of a joint from its command before the motors are switched off, rad (m).
const FOLLOWING_LIMIT: f64 = 0.2;
/// How far the encoder jumps in [`FaultKind::Jump`], rad (m).
const JUMP: f64 = 0.3;

/// Why there is no such controller.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum RobotControllerError {
    /// The servo cannot be built.
    #[error(transparent)]
    Servo(#[from] ServoError),
    /// Joint states cannot come at this rate.
    #[error("rate_hz is {found}, expected a whole part of the servo's {servo_hz} Hz")]
    Rate { found: f64, servo_hz: f64 },
}

/// What a step did, for the log. All slices have length n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<'a> {
    /// Time since the controller started, s.
    pub t: f64,
    /// `hold`, `follow`, `stream`, `off` or `frozen`.
    pub doing: &'static str,
    /// What is commanded, rad (m); empty while the motors are off.
    pub command: &'a [f64],
    /// Commanded currents, A.
    pub current: &'a [f64],
    /// True joint coordinates, rad (m).
    pub q: &'a [f64],
    /// What happened, if anything.
    pub event: &'a str,
}

/// A robot controller around a plant.
pub struct RobotController<P> {
    robot: Robot,
    plant: P,
    joints: JointLoop,
    commander: Commander,
    fault: Option<Fault>,
    /// Nanoseconds of the robot's clock at which the controller started.
    epoch_ns: i64,
    dt_ns: i64,
    /// Servo steps for each joint state.
    per_state: usize,
    steps: u64,
    struck: bool,
    frozen: bool,
    homed: bool,
    reporter: Reporter,
    current: Vec<f64>,
    event: String,
}

impl<P: Plant> RobotController<P> {
    /// A controller around `plant`, which stands where it stands, whose clock begins at `epoch_ns`. It reports its joints
    /// `state_hz` times a second.
    ///
    /// # Errors
    /// [`RobotControllerError`] where parts do not fit or a rate is no part of the servo's.
    pub fn new(
        robot: &Robot,
        nominal: &StandardParameters,
        plant: P,
        sensing: &Sensing,
        seed: Seed,
        run: u64,
        state_hz: f64,
        epoch_ns: i64,
    ) -> Result<Self, RobotControllerError> {
        let joints = JointLoop::new(robot, nominal, sensing, seed, run)?;
        let found = plant.dof();
        if found != robot.dof() {
            return Err(ServoError::Dof { quantity: "plant", found, expected: robot.dof() }.into());
        }
        let servo_hz = robot.servo().rate_hz;
        let per_state = servo_hz / state_hz;
        if !(per_state >= 1.0 - 1e-9 && (per_state - per_state.round()).abs() < 1e-9 * per_state) {
            return Err(RobotControllerError::Rate { found: state_hz, servo_hz });
        }
        let q = plant.state().0.to_vec();
        let commander = Commander::new(JointLimits::of_robot(robot), Watchdog::default(), joints.dt(), &q);
        let reporter = Reporter::new(joints.dt() * per_state.round(), &q, run);
        Ok(Self {
            robot: robot.clone(),
            dt_ns: (joints.dt() * 1e9).round() as i64,
            per_state: per_state.round() as usize,
            plant,
            joints,
            commander,
            fault: None,
            epoch_ns,
            steps: 0,
            struck: false,
            frozen: false,
            homed: true,
            reporter,
            current: vec![0.0; q.len()],
            event: String::new(),
        })
    }

    /// Returns this controller with a fault to come.
    #[must_use]
    pub fn with_fault(mut self, fault: Option<Fault>) -> Self {
        self.fault = fault;
        self
    }

    /// Returns this controller, which has found its joints' zero positions or not. One that has not says so and moves nothing.
    #[must_use]
    pub fn with_homed(mut self, homed: bool) -> Self {
        self.homed = homed;
        self
    }

    /// Returns this controller with motors that are not what the robot file says; see [`JointLoop::with_motors`].
    #[must_use]
    pub fn with_motors(mut self, motors: &[Drive]) -> Self {
        self.joints = self.joints.with_motors(motors);
        self
    }

    /// Returns this controller with another watchdog for streamed set-points.
    #[must_use]
    pub fn with_watchdog(mut self, watchdog: Watchdog) -> Self {
        self.commander.set_watchdog(watchdog);
        self
    }

    /// Returns this controller, which treats a motion that comes while another is under way so.
    #[must_use]
    pub fn with_replacement(mut self, replacement: Replacement) -> Self {
        self.commander.set_replacement(replacement);
        self
    }

    /// How it treats a motion that comes while another is under way.
    pub fn replacement(&self) -> Replacement {
        self.commander.replacement()
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// What its joints may be commanded.
    pub fn limits(&self) -> &[JointLimits] {
        self.commander.limits()
    }

    /// Whether it hangs.
    pub fn is_frozen(&self) -> bool {
        self.frozen
    }

    /// Length of a servo step, s.
    pub fn dt(&self) -> f64 {
        self.joints.dt()
    }

    /// Time since it started by its own clock, s.
    pub fn t(&self) -> f64 {
        self.steps as f64 * self.joints.dt()
    }

    /// The robot's clock when the controller started, ns: later in life another, where the clock is stepped.
    fn epoch_ns(&self) -> i64 {
        let step_s = self.size_of(FaultKind::Clock).unwrap_or(0.0);
        self.epoch_ns + (step_s * 1e9).round() as i64
    }

    fn stamp_ns(&self) -> i64 {
        self.epoch_ns() + self.steps as i64 * self.dt_ns
    }

    /// Its state in words, as it goes out on the topic `robot_state`.
    pub fn state(&self) -> String {
        if self.struck() == Some(FaultKind::StrangeState) {
            return "EMERGENCY STOP pressed, unhomed".to_owned();
        }
        match self.commander.off() {
            Some(reason) => reason.to_owned(),
            None => format!("enabled {} {}", if self.homed { "homed" } else { "not homed" }, self.commander.doing()),
        }
    }

    /// Takes a motion that was handed over.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn follow(&mut self, spline: Spline) -> Result<(), String> {
        if self.frozen {
            return Err("frozen".to_owned());
        }
        let t = self.t();
        let start_s = if spline.start_ns == 0 { t } else { (spline.start_ns - self.epoch_ns()) as f64 * 1e-9 };
        let taken =
            if self.homed { self.commander.follow(spline, start_s, t) } else { Err("the arm is not homed".to_owned()) };
        self.note(&match &taken {
            Ok(()) => format!("motion taken, begins at {start_s:.3} s"),
            Err(reason) => format!("motion refused: {reason}"),
        });
        taken
    }

    /// Cancels the motion under way, if there is one.
    pub fn cancel(&mut self) -> bool {
        let cancelled = !self.frozen && self.commander.cancel(self.t());
        if cancelled {
            self.note("cancelled");
        }
        cancelled
    }

    /// Takes a streamed set-point, in the order of the robot file. Returns whether it is followed.
    pub fn set_point(&mut self, goal: &[f64]) -> bool {
        let moved = self.commander.began_s().is_some();
        let taken = !self.frozen && self.homed && self.commander.set_point(goal, self.t());
        if !moved && self.commander.began_s().is_some() {
            self.note("motion begins");
        }
        if !taken {
            self.note("set-point not taken");
        }
        taken
    }

    /// Switches the motors off and the brakes on, for good. Returns whether they were on.
    pub fn disable(&mut self, reason: &str) -> bool {
        let on = self.commander.off().is_none();
        if on {
            self.note(reason);
            self.commander.switch_off(reason);
        }
        on
    }

    /// Puts a remark into the log of the next step.
    pub fn remark(&mut self, event: &str) {
        if !self.frozen {
            self.note(event);
        }
    }

    fn remark_if(&mut self, event: Option<String>) {
        if let Some(event) = event {
            self.note(&event);
        }
    }

    fn note(&mut self, event: &str) {
        if !self.event.is_empty() {
            self.event.push_str("; ");
        }
        self.event.push_str(event);
    }

    /// The fault that has struck.
    pub(super) fn struck(&self) -> Option<FaultKind> {
        self.fault.filter(|_| self.struck).map(|fault| fault.kind)
    }

    /// Size of the fault of this kind, where it has struck.
    pub(super) fn size_of(&self, kind: FaultKind) -> Option<f64> {
        self.fault.filter(|fault| self.struck && fault.kind == kind).map(|fault| fault.size)
    }

    fn strike(&mut self, output: &mut Vec<Output>) {
        let Some(fault) = self.fault.filter(|_| !self.struck) else { return };
        let since =
            if fault.of_motion { self.commander.began_s().map(|began| self.t() - began) } else { Some(self.t()) };
        if since.is_none_or(|since| since < fault.at_s) {
            return;
        }
        self.struck = true;
        self.note(&format!("fault {}", fault.kind.name()));
        match fault.kind {
            FaultKind::Freeze => {
                self.frozen = true;
                self.commander.switch_off("frozen");
                // The drives miss their servo: no current, brakes on.
                self.current.fill(0.0);
            }
            FaultKind::Estop => {
                self.disable("estop");
            }
            FaultKind::Die => output.push(Output::Die),
            FaultKind::LateExecution | FaultKind::LostGoal => self.commander.join_anywhere(),
            _ => {}
        }
    }

    /// One servo step: sensors, faults, command, motors, plant. What is to be sent goes into `output`, what was done to
    /// `log`.
    ///
    /// # Errors
    /// [`PlantError`] where the plant fails.
    pub fn step(&mut self, output: &mut Vec<Output>, log: &mut dyn FnMut(&Report<'_>)) -> Result<(), PlantError> {
        let t = self.t();
        self.strike(output);
        if self.frozen {
            if !self.event.is_empty() {
                self.report(log);
            }
            self.steps += 1;
            return Ok(());
        }
        let moved = self.commander.began_s().is_some();
        self.commander.step(t);
        if !moved && self.commander.began_s().is_some() {
            self.note("motion begins");
        }
        let q = self.plant.state().0.to_vec();
        let mut seen = q.clone();
        if self.struck() == Some(FaultKind::Jump) {
            seen[0] += JUMP;
        }
        if self.commander.off().is_none() {
            self.joints.step(self.commander.command(), &seen, self.plant.state().1);
            self.watch_following(&seen);
        }
        if self.commander.off().is_some() {
            self.joints.rest(&seen);
        }
        self.current.copy_from_slice(self.joints.current());
        if self.steps.is_multiple_of(self.per_state as u64) {
            match Time::from_ns(self.stamp_ns()) {
                Ok(stamp) => {
                    let fault = self.struck();
                    let state = self.reporter.state(&self.robot, &mut self.joints, stamp, fault);
                    let remark = self.reporter.send(state, t, fault, output);
                    self.remark_if(remark);
                }
                // A state with a wrong stamp is worse than none: the motors go off, and states end.
                Err(fault) => {
                    self.disable(&format!("fault: {fault}"));
                }
            }
        }
        let remark = self.reporter.release(t, output);
        self.remark_if(remark);
        if let Some(outcome) = self.commander.outcome() {
            output.push(Output::Ended(outcome, self.commander.off().unwrap_or_default().to_owned()));
        }
        self.report(log);
        if self.commander.off().is_some() {
            // The brakes hold the arm where it is.
            self.plant.reset(&q, &vec![0.0; q.len()]);
        } else {
            self.plant.step(self.joints.tau(), self.joints.dt())?;
        }
        self.steps += 1;
        Ok(())
    }

    fn watch_following(&mut self, seen: &[f64]) {
        let command = self.commander.command();
        let far = (0..seen.len()).find(|&j| (command[j] - seen[j]).abs() > FOLLOWING_LIMIT);
        if let Some(j) = far {
            let (name, found) = (&self.robot.joints()[j].name, (command[j] - seen[j]).abs());
            let reason = format!("fault: joint {name} is {found:.3} from its command, more than {FOLLOWING_LIMIT}");
            self.disable(&reason);
        }
    }

    fn report(&mut self, log: &mut dyn FnMut(&Report<'_>)) {
        let doing = if self.frozen { "frozen" } else { self.commander.doing() };
        let on = self.commander.off().is_none();
        let command = if on { self.commander.command() } else { &[] };
        let (t, current, q) = (self.t(), &self.current, self.plant.state().0);
        log(&Report { t, doing, command, current, q, event: &self.event });
        self.event.clear();
    }
}

#[cfg(test)]
mod tests;
