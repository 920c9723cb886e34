//! The servo between two steps of its plant: sensors, controller, phases, samples. No plant inside, so that several
//! runs can share the steps of one.

use std::sync::Arc;

use super::effects::{ActualDrives, SampleClock};
use super::motors::Motors;
use super::sensing::Sensors;
use super::{CommandTable, Divergence, Ending, JointPid, Layout, Phase, RawSample, Rest, Sink, Tracking, Transmission};
use crate::model::{EffortInterface, Robot};

/// The true state behind one sample, for tests, scoring and bounds; no sensor sees it. All slices have length n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueState<'a> {
    /// Position in the experiment, from zero.
    pub index: usize,
    /// Time since the beginning of the experiment, s.
    pub t: f64,
    /// What the arm is doing.
    pub phase: Phase,
    /// Joint coordinates, rad (m).
    pub q: &'a [f64],
    /// Joint velocities, rad/s (m/s).
    pub qd: &'a [f64],
    /// Effort of the motors on the joints, held from this moment to the next servo step, N·m (N); as the servo means it,
    /// where effects of the drives make another of it.
    pub tau: &'a [f64],
}

/// What a cycle wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Step the plant under [`Cycle::tau`].
    Step,
    /// The experiment is over.
    End(Ending),
}

/// One experiment as a sequence of servo steps.
#[derive(Clone, Debug)]
pub struct Cycle {
    layout: Arc<Layout>,
    table: Arc<CommandTable>,
    rate_hz: f64,
    per_sample: usize,
    effort: EffortInterface,
    joints: Vec<String>,
    /// Ten times the speed limits.
    runaway: Vec<f64>,
    transmission: Transmission,
    motors: Motors,
    controller: JointPid,
    sensors: Sensors,
    drives: Option<Box<ActualDrives>>,
    clock: Option<SampleClock>,
    tracking: Tracking,
    step: usize,
    sample: usize,
    phase: usize,
    q_motor: Vec<f64>,
    qd_motor: Vec<f64>,
    command_motor: Vec<f64>,
    measured: Vec<f64>,
    current: Vec<f64>,
    before: Vec<f64>,
    torque_motor: Vec<f64>,
    tau: Vec<f64>,
    sensed: Vec<f64>,
    q_sample: Vec<f64>,
    effort_sample: Vec<f64>,
    voltage_sample: Vec<f64>,
}

/// Everything a cycle is made of.
pub(super) struct CycleSpec<'a> {
    pub(super) robot: &'a Robot,
    pub(super) layout: Arc<Layout>,
    pub(super) table: Arc<CommandTable>,
    pub(super) rate_hz: f64,
    pub(super) per_sample: usize,
    pub(super) transmission: Transmission,
    pub(super) motors: Motors,
    pub(super) controller: JointPid,
    pub(super) sensors: Sensors,
    pub(super) drives: Option<ActualDrives>,
    pub(super) clock: Option<SampleClock>,
}

impl Cycle {
    pub(super) fn new(spec: CycleSpec<'_>) -> Self {
        let CycleSpec {
            robot,
            layout,
            table,
            rate_hz,
            per_sample,
            transmission,
            motors,
            mut controller,
            sensors,
            drives,
            clock,
        } = spec;
        controller.reset();
        let n = robot.dof();
        let zero = || vec![0.0; n];
        Self {
            layout,
            table,
            rate_hz,
            per_sample,
            effort: robot.effort(),
            joints: robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            runaway: robot.joints().iter().map(|joint| 10.0 * joint.limits.velocity).collect(),
            transmission,
            motors,
            controller,
            sensors,
            drives: drives.map(Box::new),
            clock,
            tracking: Tracking::new(n),
            step: 0,
            sample: 0,
            phase: 0,
            q_motor: zero(),
            qd_motor: zero(),
            command_motor: zero(),
            measured: zero(),
            current: zero(),
            before: zero(),
            torque_motor: zero(),
            tau: zero(),
            sensed: zero(),
            q_sample: zero(),
            effort_sample: zero(),
            voltage_sample: zero(),
        }
    }

    /// Length of a servo step, s.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.controller.dt()
    }

    /// Where the plant must be at rest when the experiment begins, n.
    #[must_use]
    pub fn start(&self) -> &[f64] {
        self.table.row(0)
    }

    /// Steps of the plant in a servo step, of equal length: one, unless effects of the drives need more.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.drives.as_ref().map_or(1, |drives| drives.parts())
    }

    /// What the motors exert on the joints until the next step of the plant, N·m (N); n.
    #[must_use]
    pub fn tau(&self) -> &[f64] {
        &self.tau
    }

    /// Decides [`Cycle::tau`] for the next of [`Cycle::parts`] steps of the plant, which is at `q`, `qd`. Without effects
    /// of the drives it stays what the servo step decided.
    pub fn push(&mut self, q: &[f64], qd: &[f64]) {
        if let Some(drives) = &mut self.drives {
            drives.push(q, qd, &mut self.tau);
        }
    }

    /// How well the command was followed so far; mean errors only after the end.
    #[must_use]
    pub fn tracking(&self) -> &Tracking {
        &self.tracking
    }

    /// One servo step at the plant's state `q`, `qd`: reads the sensors, decides [`Cycle::tau`], hands a sample to the
    /// sink where one is due. [`Cycle::parts`] steps of the plant follow, each after [`Cycle::push`].
    pub fn advance(
        &mut self,
        q: &[f64],
        qd: &[f64],
        sink: &mut dyn Sink,
        observer: &mut dyn FnMut(&TrueState<'_>),
    ) -> Next {
        let due = self.step.is_multiple_of(self.per_sample);
        while due && self.phase < self.layout.spans.len() && self.sample >= self.layout.spans[self.phase].samples.end {
            self.phase += 1;
        }
        let Some(span) = self.layout.spans.get(self.phase) else { return self.end(Ending::Completed) };
        let phase = span.phase;
        if let Some(reason) = self.runaway(q, qd) {
            return self.end(Ending::Diverged { t: self.step as f64 * self.dt(), phase, reason });
        }
        let command = self.table.row(self.step);
        self.transmission.motor_motion(q, &mut self.q_motor);
        self.transmission.motor_motion(command, &mut self.command_motor);
        if let Some(drives) = &self.drives {
            drives.positions(&mut self.q_motor);
        }
        self.sensors.positions(&self.q_motor, &mut self.measured);
        self.before.copy_from_slice(&self.current);
        let mut saturated = self.controller.step(&self.command_motor, &self.measured, &mut self.current);
        self.transmission.motor_motion(qd, &mut self.qd_motor);
        if let Some(drives) = &self.drives {
            drives.speeds(&mut self.qd_motor);
        }
        saturated |= self.motors.saturate(&self.qd_motor, &mut self.current);
        if self.step == 0 {
            self.before.copy_from_slice(&self.current);
        }
        for i in 0..self.tau.len() {
            self.torque_motor[i] = self.motors.per_ampere()[i] * self.current[i];
        }
        self.transmission.joint_torque(&self.torque_motor, &mut self.tau);
        if let Some(drives) = &mut self.drives {
            drives.set(&self.current);
        }
        self.tracking.saturated_steps += usize::from(saturated);
        if phase == Phase::Record {
            self.tracking.add(command, q, &self.tau, &self.current);
        }
        self.step += 1;
        if due {
            let (index, t) = (self.sample, self.sample as f64 / self.rate_hz);
            self.sample += 1;
            let lost = self.read(qd);
            let voltage: &[f64] = if self.sensors.has_voltage() {
                if !lost {
                    self.motors.voltages(&self.before, &self.current, &self.qd_motor, &mut self.voltage_sample);
                    self.sensors.voltages(&mut self.voltage_sample);
                }
                &self.voltage_sample
            } else {
                &[]
            };
            observer(&TrueState { index, t, phase, q, qd, tau: &self.tau });
            let command = self.table.row(self.step - 1);
            let sample =
                RawSample { index, t, phase, q: &self.q_sample, effort: &self.effort_sample, voltage, command };
            if sink.sample(&sample).ends() {
                return self.end(Ending::Stopped { t, phase, rest: Rest::Simulated });
            }
        }
        Next::Step
    }

    /// Ends the experiment because the plant gave up.
    pub fn fail(&mut self, fault: super::PlantError) -> Ending {
        let phase = self.layout.spans.get(self.phase).map_or(Phase::RampOut, |span| span.phase);
        let t = self.step as f64 * self.dt();
        self.tracking.finish();
        Ending::Diverged { t, phase, reason: Divergence::Plant(fault) }
    }

    fn end(&mut self, ending: Ending) -> Next {
        self.tracking.finish();
        Next::End(ending)
    }

    /// Takes a sample, at the time that it is stamped with unless the clock says otherwise; returns whether it is lost,
    /// so that the one before stands in its place.
    fn read(&mut self, qd: &[f64]) -> bool {
        let (mut late, mut lost) = (0.0, false);
        if let Some(clock) = &mut self.clock {
            (late, lost) = (clock.lateness(), clock.loses());
            self.sensors.late = late / self.controller.dt();
        }
        if late != 0.0 {
            self.transmission.motor_motion(qd, &mut self.qd_motor);
            if let Some(drives) = &self.drives {
                drives.speeds(&mut self.qd_motor);
            }
            for (q, qd) in self.q_motor.iter_mut().zip(&self.qd_motor) {
                *q += late * qd;
            }
            self.sensors.positions(&self.q_motor, &mut self.measured);
        }
        self.sensors.currents(&self.before, &self.current, &mut self.sensed);
        if !lost {
            self.transmission.joint_motion(&self.measured, &mut self.q_sample);
            self.report();
        }
        lost
    }

    /// Currents as the robot reports them.
    fn report(&mut self) {
        match self.effort {
            EffortInterface::Current => self.effort_sample.copy_from_slice(&self.sensed),
            EffortInterface::Torque => {
                for i in 0..self.sensed.len() {
                    self.torque_motor[i] = self.transmission.per_ampere()[i] * self.sensed[i];
                }
                self.transmission.joint_torque(&self.torque_motor, &mut self.effort_sample);
            }
        }
    }

    fn runaway(&self, q: &[f64], qd: &[f64]) -> Option<Divergence> {
        if let Some(fault) = super::PlantError::of_state(q, qd) {
            return Some(Divergence::Plant(fault));
        }
        let i = (0..qd.len()).find(|&i| qd[i].abs() > self.runaway[i])?;
        Some(Divergence::Speed { joint: self.joints[i].clone(), found: qd[i].abs(), limit: self.runaway[i] / 10.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{Arm, ExperimentPlan, Flow, Plant, PlantError, Recording, Servo};

    fn servo<P: Plant>(plant: P) -> Servo<P> {
        Servo::new(&hinges::single(), &hinges::parameters(1), plant).unwrap()
    }

    #[test]
    fn a_sink_can_stop_and_a_runaway_ends_with_its_reason() {
        struct Until(f64);
        impl Sink for Until {
            fn begin(&mut self, _: &Recording) {}
            fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
                if sample.t < self.0 { Flow::Continue } else { Flow::Stop }
            }
        }
        let plan = ExperimentPlan { settle_s: 0.2, ramp_s: 0.5, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let ending = servo(FlyWheels::new(1)).perform(&plan, &mut Until(0.5)).unwrap();
        assert_eq!(ending, Ending::Stopped { t: 0.5, phase: Phase::RampIn, rest: Rest::Simulated });

        /// A plant that starts to move by itself.
        struct Runaway(FlyWheels, f64);
        impl Plant for Runaway {
            fn dof(&self) -> usize {
                1
            }
            fn state(&self) -> (&[f64], &[f64]) {
                self.0.state()
            }
            fn reset(&mut self, q: &[f64], qd: &[f64]) {
                self.0.reset(q, qd);
            }
            fn step(&mut self, _: &[f64], dt: f64) -> Result<(), PlantError> {
                self.0.step(&[self.1], dt)
            }
        }
        for torque in [1e4, f64::NAN] {
            let plant = Runaway(FlyWheels::new(1), torque);
            let ending = servo(plant).perform(&plan, &mut Until(9e9)).unwrap();
            match ending {
                Ending::Diverged { reason: Divergence::Speed { found, limit, .. }, t, .. } => {
                    // 1e4 N·m on 2 kg·m² passes 30 rad/s after 6 ms.
                    assert!(torque.is_finite() && found > 10.0 * limit && (0.005..0.008).contains(&t));
                }
                Ending::Diverged { reason: Divergence::Plant(PlantError::NotFinite { joint: 1, .. }), .. } => {
                    assert!(torque.is_nan());
                }
                other => panic!("{other:?}"),
            }
        }
    }
}
