//! The analytic plant under position servos, along the commands of logs.
//!
//! ```text
//! τ(t) = Kp (q_cmd(t − d) + z − q(t)) − Kd q̇(t)
//! ```
//! Stiffness is held over a step, at the position that is expected in the middle of it, so that the loop is that of a servo without steps of
//! its own, but for the square of a step's length. Damping is the arm's: viscous friction to which Kd is added. Steps are those of the
//! log, or parts of them that the stiffest joint needs with nominal parameters.

use std::ops::Range;

use armid::dynamics::States;
use armid::estimation::{
    ClosedLoop, ClosedLoopError, ClosedLoopMotion, ClosedLoopSlopes, CommandedLoop, PositionServo, ServoPart,
    interpolate,
};
use armid::experiment::{DivergenceError, Plant};
use armid::model::term::VISCOUS;
use armid::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};
use armid::observer::Observer;
use armid::signal::Samples;
use nalgebra::DMatrix;

use super::walk::{go_on, runaway};
use crate::AnalyticPlant;
use crate::analytic::sloped_arm;

/// Longest step, s.
const STEP_S: f64 = 1e-3;
/// Part of the shortest time of a joint under its servo that a step takes at most.
const PART: f64 = 0.2;
/// Most steps in a sample: a servo that needs more is none that this loop can follow.
const MOST_STEPS: f64 = 200.0;

/// The arm along the commands of logs.
#[derive(Debug)]
pub(super) struct CommandLoop {
    robot: Robot,
    nominal: StandardParameters,
    servo: PositionServo,
    logs: Vec<CommandLog>,
}

/// Commands at the samples of one log.
#[derive(Debug)]
struct CommandLog {
    /// In the samples' coordinates, N × n.
    commands: Vec<f64>,
    rate_hz: f64,
    /// Steps in a sample.
    steps: usize,
    /// Measured positions and velocities of the first sample, 2 n.
    start: Vec<f64>,
}

/// By what derivatives are taken: parameters, unknown numbers of the servos, and where `starts` says so, the states of the logs.
struct Directions<'a> {
    by: &'a [ParameterId],
    unknown: &'a [ServoPart],
    starts: bool,
}

impl CommandLoop {
    pub(super) fn new(
        robot: &Robot,
        nominal: &StandardParameters,
        servo: &PositionServo,
        samples: &[Samples],
    ) -> Result<Self, ClosedLoopError> {
        let unsimulable = |reason: String| ClosedLoopError::Unsimulable { reason };
        if let Some(fault) = servo.fault(robot.dof()) {
            return Err(unsimulable(fault));
        }
        if robot.coupling().is_some() {
            return Err(unsimulable(
                "its motors are coupled, expected position servos that each turn a joint".to_owned(),
            ));
        }
        let n = robot.dof();
        // Without friction, which no step depends on.
        let inertias = nominal.vector(robot, Columns::RIGID_ROTOR);
        let inertias = StandardParameters::from_vector(robot, Columns::RIGID_ROTOR, inertias.as_slice());
        let mut plant = AnalyticPlant::new(robot, &inertias).map_err(|fault| unsimulable(fault.to_string()))?;
        let log = |of: &Samples| {
            let start = [&of.states.q[..n], &of.states.qd[..n]].concat();
            let most = shortest(&mut plant, servo, &start[..n]).min(STEP_S / PART) * PART;
            let steps = (1.0 / (of.rate_hz * most)).ceil();
            if steps.is_nan() || steps > MOST_STEPS {
                return Err(unsimulable(format!(
                    "its servos need {steps} steps in a sample of {} s, expected at most {MOST_STEPS}",
                    1.0 / of.rate_hz
                )));
            }
            Ok(CommandLog { commands: servo.commands(of), rate_hz: of.rate_hz, steps: steps.max(1.0) as usize, start })
        };
        let logs = samples.iter().map(log).collect::<Result<_, _>>()?;
        Ok(Self { robot: robot.clone(), nominal: nominal.clone(), servo: servo.clone(), logs })
    }

    /// The motions of all logs one after the other.
    fn walked(
        &self,
        parameters: &StandardParameters,
        servo: &PositionServo,
        starts: &[f64],
        directions: &Directions<'_>,
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        let n = self.robot.dof();
        let width = directions.by.len() + directions.unknown.len();
        let d = width + if directions.starts { 2 * n * self.logs.len() } else { 0 };
        let states = States { dof: n, q: Vec::new(), qd: Vec::new(), qdd: Vec::new() };
        let mut motion = ClosedLoopMotion { states, tau: Vec::new() };
        let blocks: usize = self.logs.iter().map(|log| log.commands.len() / n / block).sum();
        let mut slopes = ClosedLoopSlopes { q: DMatrix::zeros(blocks * n, d), tau: DMatrix::zeros(blocks * n, d) };
        let mut first = 0;
        for (at, (log, start)) in self.logs.iter().zip(starts.chunks_exact(2 * n)).enumerate() {
            let own = width + 2 * n * at..width + 2 * n * (at + 1);
            let mut walk = Walk::new(&self.robot, parameters, (servo, &self.servo), log, directions)?;
            walk.begin(start);
            let rows = log.commands.len() / n;
            for row in 0..rows {
                go_on(observer, row, rows)?;
                walk.sample(&mut motion)?;
                let within = row / block;
                if within < rows / block {
                    walk.add(&mut slopes, (first + within) * n, &own, block);
                }
                walk.advance()?;
            }
            first += rows / block;
        }
        Ok((motion, slopes))
    }

    fn measured(&self) -> Vec<f64> {
        self.logs.iter().flat_map(|log| log.start.iter().copied()).collect()
    }
}

/// The shortest time of any joint under its servo, s: `√(I/Kp)`, with I what the joint feels of the arm alone.
fn shortest(plant: &mut AnalyticPlant, servo: &PositionServo, q: &[f64]) -> f64 {
    let n = q.len();
    let (mut tau, mut at_rest, mut pushed) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    Plant::reset(plant, q, &tau);
    plant.acceleration(&tau, &mut at_rest);
    let mut shortest = f64::INFINITY;
    for i in 0..n {
        tau[i] = 1.0;
        plant.acceleration(&tau, &mut pushed);
        tau[i] = 0.0;
        shortest = shortest.min(1.0 / (servo.kp[i] * (pushed[i] - at_rest[i])).sqrt());
    }
    shortest
}

/// The viscous friction of a joint.
fn viscous(joint: usize) -> ParameterId {
    ParameterId { index: joint, kind: ParameterKind::Term(VISCOUS) }
}

/// One log, as far as it has been simulated.
struct Walk<'a> {
    robot: &'a Robot,
    servo: &'a PositionServo,
    log: &'a CommandLog,
    directions: &'a Directions<'a>,
    arm: Box<dyn crate::analytic::SlopedArm>,
    plant: AnalyticPlant,
    /// How much later commands act than by the stated servo, samples.
    later: f64,
    /// What is added to the samples' positions, rad (m), n.
    zero: Vec<f64>,
    dt: f64,
    /// Steps so far.
    step: usize,
    /// Derivatives that there are, of this log.
    d: usize,
    /// Where the derivatives by what is unknown are among the arm's: damping is a parameter of it.
    places: Vec<usize>,
    tau: Vec<f64>,
    of_tau: Vec<f64>,
}

impl<'a> Walk<'a> {
    fn new(
        robot: &'a Robot,
        parameters: &StandardParameters,
        (servo, stated): (&'a PositionServo, &PositionServo),
        log: &'a CommandLog,
        directions: &'a Directions<'a>,
    ) -> Result<Self, ClosedLoopError> {
        let unsimulable =
            |fault: crate::analytic::AnalyticError| ClosedLoopError::Unsimulable { reason: fault.to_string() };
        let n = robot.dof();
        let mut of_arm = parameters.clone();
        for (joint, kd) in servo.kd.iter().enumerate() {
            of_arm.set(viscous(joint), of_arm.get(viscous(joint)) + kd);
        }
        let dampings = directions.unknown.iter().filter_map(|part| match *part {
            ServoPart::Damping(joint) => Some(viscous(joint)),
            ServoPart::Stiffness(_) | ServoPart::Delay | ServoPart::Zero(_) => None,
        });
        let by: Vec<ParameterId> = directions.by.iter().copied().chain(dampings).collect();
        let (mut of_parameters, mut others) = (directions.by.len(), by.len());
        let place = |part: &ServoPart| {
            let next = if matches!(part, ServoPart::Damping(_)) { &mut of_parameters } else { &mut others };
            *next += 1;
            *next - 1
        };
        let places = directions.unknown.iter().map(place).collect();
        let d = directions.by.len() + directions.unknown.len() + if directions.starts { 2 * n } else { 0 };
        Ok(Self {
            robot,
            servo,
            log,
            directions,
            arm: sloped_arm(robot, &of_arm, &by, d - by.len()).map_err(unsimulable)?,
            plant: AnalyticPlant::new(robot, &of_arm).map_err(unsimulable)?,
            places,
            later: (servo.delay_s - stated.delay_s) * log.rate_hz,
            zero: (0..n).map(ServoPart::Zero).map(|part| servo.value(part) - stated.value(part)).collect(),
            dt: 1.0 / (log.rate_hz * log.steps as f64),
            step: 0,
            d,
            tau: vec![0.0; n],
            of_tau: vec![0.0; n * d],
        })
    }

    /// Puts the arm into a state, 2 n, of the samples.
    fn begin(&mut self, start: &[f64]) {
        let (n, d) = (self.robot.dof(), self.d);
        let (mut of_q, mut of_v) = (vec![0.0; n * d], vec![0.0; n * d]);
        for (&at, part) in self.places.iter().zip(self.directions.unknown) {
            if let ServoPart::Zero(joint) = part {
                of_q[joint * d + at] = 1.0;
            }
        }
        if self.directions.starts {
            for i in 0..n {
                of_q[i * d + d - 2 * n + i] = 1.0;
                of_v[i * d + d - n + i] = 1.0;
            }
        }
        let q: Vec<f64> = (0..n).map(|i| start[i] + self.zero[i]).collect();
        self.arm.begin((&q, &start[n..]), (&of_q, &of_v));
    }

    /// Torque of the servos' stiffness and its derivatives so many steps ahead, at the positions that are expected there.
    fn decide(&mut self, ahead: f64) {
        let (n, d) = (self.robot.dof(), self.d);
        let (q, v) = self.arm.state();
        let (of_q, of_v) = self.arm.slopes();
        let h = ahead * self.dt;
        let row = (self.step as f64 + ahead) / self.log.steps as f64 - self.later;
        for i in 0..n {
            let kp = self.servo.kp[i];
            let (command, rise) = interpolate(&self.log.commands, n, i, row);
            let error = command + self.zero[i] - (q[i] + h * v[i]);
            self.tau[i] = kp * error;
            for j in i * d..(i + 1) * d {
                self.of_tau[j] = -kp * (of_q[j] + h * of_v[j]);
            }
            for (&at, part) in self.places.iter().zip(self.directions.unknown) {
                self.of_tau[i * d + at] += match *part {
                    ServoPart::Stiffness(joint) if joint == i => error,
                    ServoPart::Zero(joint) if joint == i => kp,
                    ServoPart::Delay => -kp * rise * self.log.rate_hz,
                    ServoPart::Stiffness(_) | ServoPart::Damping(_) | ServoPart::Zero(_) => 0.0,
                };
            }
        }
    }

    /// Takes the servos' damping off the torque that [`Self::decide`] found at a sample.
    fn damp(&mut self) {
        let d = self.d;
        let ((_, v), (_, of_v)) = (self.arm.state(), self.arm.slopes());
        for (i, (tau, v)) in self.tau.iter_mut().zip(v).enumerate() {
            let kd = self.servo.kd[i];
            *tau -= kd * v;
            for (tau, v) in self.of_tau[i * d..].iter_mut().zip(&of_v[i * d..(i + 1) * d]) {
                *tau -= kd * v;
            }
            for (&at, part) in self.places.iter().zip(self.directions.unknown) {
                if matches!(*part, ServoPart::Damping(joint) if joint == i) {
                    self.of_tau[i * d + at] -= v;
                }
            }
        }
    }

    /// Adds the motion at this sample, positions as the samples have them.
    fn sample(&mut self, motion: &mut ClosedLoopMotion) -> Result<(), ClosedLoopError> {
        self.decide(0.0);
        let (q, v) = self.arm.state();
        let mut qdd = vec![0.0; q.len()];
        Plant::reset(&mut self.plant, q, v);
        if !self.plant.definite_acceleration(&self.tau, &mut qdd) {
            return Err(ClosedLoopError::MassMatrix { t: self.step as f64 * self.dt });
        }
        self.damp();
        let (q, v) = self.arm.state();
        motion.states.q.extend(q.iter().zip(&self.zero).map(|(q, zero)| q - zero));
        motion.states.qd.extend_from_slice(v);
        motion.states.qdd.extend_from_slice(&qdd);
        motion.tau.extend_from_slice(&self.tau);
        Ok(())
    }

    /// Adds the derivatives at this sample to means over `block` samples, from `row` on; those by this log's state in its `own` columns.
    fn add(&self, slopes: &mut ClosedLoopSlopes, row: usize, own: &Range<usize>, block: usize) {
        let (d, n, b) = (self.d, self.robot.dof(), self.directions.by.len());
        let width = b + self.directions.unknown.len();
        let (of_q, _) = self.arm.slopes();
        for (table, values) in [(&mut slopes.q, of_q), (&mut slopes.tau, &self.of_tau[..])] {
            for i in 0..n {
                let parameters = (0..b).map(|j| (j, j));
                let servos = self.places.iter().enumerate().map(|(at, &place)| (b + at, place));
                let starts = (width..d).map(|j| (own.start + j - width, j));
                for (column, j) in parameters.chain(servos).chain(starts) {
                    table[(row + i, column)] += values[i * d + j] / block as f64;
                }
            }
        }
        for (at, part) in self.directions.unknown.iter().enumerate() {
            if let ServoPart::Zero(joint) = part {
                slopes.q[(row + joint, b + at)] -= 1.0 / block as f64;
            }
        }
    }

    /// To the next sample.
    fn advance(&mut self) -> Result<(), ClosedLoopError> {
        for _ in 0..self.log.steps {
            let t = self.step as f64 * self.dt;
            self.decide(0.5);
            if let Err(fault) = self.arm.step(&self.tau, &self.of_tau, self.dt) {
                return Err(ClosedLoopError::Diverged { t, reason: DivergenceError::Plant(fault) });
            }
            self.step += 1;
            let (q, v) = self.arm.state();
            if let Some(reason) = runaway(self.robot, q, v) {
                return Err(ClosedLoopError::Diverged { t, reason });
            }
        }
        Ok(())
    }
}

impl ClosedLoop for CommandLoop {
    fn nominal(&self) -> &StandardParameters {
        &self.nominal
    }

    fn motion(
        &self,
        parameters: &StandardParameters,
        observer: &dyn Observer,
    ) -> Result<ClosedLoopMotion, ClosedLoopError> {
        Ok(self.slopes(parameters, &[], 1, observer)?.0)
    }

    fn slopes(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        let directions = Directions { by, unknown: &[], starts: false };
        self.walked(parameters, &self.servo, &self.measured(), &directions, block, observer)
    }

    fn commanded(&self) -> Option<&dyn CommandedLoop> {
        Some(self)
    }
}

impl CommandedLoop for CommandLoop {
    fn servo(&self) -> &PositionServo {
        &self.servo
    }

    fn starts(&self) -> Vec<f64> {
        self.measured()
    }

    fn slopes_from(
        &self,
        parameters: &StandardParameters,
        servo: &PositionServo,
        starts: &[f64],
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        let directions = Directions { by, unknown: &self.servo.unknown, starts: true };
        self.walked(parameters, servo, starts, &directions, block, observer)
    }
}
