//! An experiment between two steps of its plant: commands, phases, samples around the loop of the joints. No plant inside,
//! so that several runs can share the steps of one.

use std::sync::Arc;

use super::arm::{DivergenceError, Ending, Sink};
use super::command_table::CommandTable;
use super::effects::{ClockSlips, SampleClock};
use super::joint_loop::JointLoop;
use super::layout::Layout;
use super::phase::Phase;
use super::plant::PlantError;
use super::raw_sample::RawSample;
use super::tracking::Tracking;
use super::trip::Rest;
use crate::model::Robot;

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
    timing: Timing,
    names: Vec<String>,
    /// Ten times the speed limits.
    runaway: Vec<f64>,
    joints: JointLoop,
    clock: Option<SampleClock>,
    slips: Option<ClockSlips>,
    tracking: Tracking,
    step: usize,
    sample: usize,
    phase: usize,
}

/// What is commanded when, shared by all runs of a plan.
#[derive(Clone, Debug)]
pub(super) struct Timing {
    pub(super) layout: Arc<Layout>,
    pub(super) table: Arc<CommandTable>,
    pub(super) rate_hz: f64,
    /// Servo steps.
    pub(super) per_sample: usize,
}

impl Cycle {
    pub(super) fn new(
        robot: &Robot,
        timing: Timing,
        joints: JointLoop,
        clock: Option<SampleClock>,
        slips: Option<ClockSlips>,
    ) -> Self {
        Self {
            timing,
            names: robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            runaway: robot.joints().iter().map(|joint| 10.0 * joint.limits.velocity).collect(),
            joints,
            clock,
            slips,
            tracking: Tracking::new(robot.dof()),
            step: 0,
            sample: 0,
            phase: 0,
        }
    }

    /// Length of a servo step, s.
    pub fn dt(&self) -> f64 {
        self.joints.dt()
    }

    /// Where the plant must be at rest when the experiment begins, n.
    pub fn start(&self) -> &[f64] {
        self.timing.table.row(0)
    }

    /// Steps of the plant in a servo step, of equal length: one, unless effects of the drives need more.
    pub fn parts(&self) -> usize {
        self.joints.parts()
    }

    /// What the motors exert on the joints until the next step of the plant, N·m (N); n.
    pub fn tau(&self) -> &[f64] {
        self.joints.tau()
    }

    /// Decides [`Cycle::tau`] for the next of [`Cycle::parts`] steps of the plant, which is at `q`, `qd`. Without effects
    /// of the drives it stays what the servo step decided.
    pub fn push(&mut self, q: &[f64], qd: &[f64]) {
        self.joints.push(q, qd);
    }

    /// How well the command was followed so far; mean errors only after the end.
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
        let due = self.step.is_multiple_of(self.timing.per_sample);
        while due
            && self.phase < self.timing.layout.spans.len()
            && self.sample >= self.timing.layout.spans[self.phase].samples.end
        {
            self.phase += 1;
        }
        let Some(span) = self.timing.layout.spans.get(self.phase) else { return self.end(Ending::Completed) };
        let phase = span.phase;
        if let Some(reason) = self.runaway(q, qd) {
            return self.end(Ending::Diverged { t: self.step as f64 * self.dt(), phase, reason });
        }
        let command = self.timing.table.row(self.step);
        let saturated = self.joints.step(command, q, qd);
        self.tracking.saturated_steps += usize::from(saturated);
        if phase == Phase::Record {
            self.tracking.add(command, q, self.joints.tau(), self.joints.current());
        }
        self.step += 1;
        if due {
            let (index, t) = (self.sample, self.sample as f64 / self.timing.rate_hz);
            self.sample += 1;
            // At the time that the sample is stamped with, unless the clock says otherwise. Where it is lost, the one before
            // stands in its place.
            let (late_s, lost) = self.clock.as_mut().map_or((0.0, false), |clock| (clock.lateness(), clock.loses()));
            self.joints.sense_late(late_s, lost);
            observer(&TrueState { index, t, phase, q, qd, tau: self.joints.tau() });
            let mut put = |[q, effort, voltage, link_q]: [&[f64]; 4]| {
                sink.sample(&RawSample { index, t, phase, q, effort, voltage, link_q, command })
            };
            let reported = self.joints.reported();
            let flow = match &mut self.slips {
                None => put(reported),
                Some(slips) => put(slips.written(reported)),
            };
            if flow.ends() {
                return self.end(Ending::Stopped { t, phase, rest: Rest::Simulated });
            }
        }
        Next::Step
    }

    /// Ends the experiment because the plant failed.
    pub fn fail(&mut self, fault: PlantError) -> Ending {
        let phase = self.timing.layout.spans.get(self.phase).map_or(Phase::RampOut, |span| span.phase);
        let t = self.step as f64 * self.dt();
        self.tracking.finish();
        Ending::Diverged { t, phase, reason: DivergenceError::Plant(fault) }
    }

    fn end(&mut self, ending: Ending) -> Next {
        self.tracking.finish();
        Next::End(ending)
    }

    fn runaway(&self, q: &[f64], qd: &[f64]) -> Option<DivergenceError> {
        if let Some(fault) = PlantError::of_state(q, qd) {
            return Some(DivergenceError::Plant(fault));
        }
        let i = qd.iter().zip(&self.runaway).position(|(qd, limit)| qd.abs() > *limit)?;
        Some(DivergenceError::Speed { joint: self.names[i].clone(), found: qd[i].abs(), limit: self.runaway[i] / 10.0 })
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
                Ending::Diverged { reason: DivergenceError::Speed { found, limit, .. }, t, .. } => {
                    // 1e4 N·m on 2 kg·m² passes 30 rad/s after 6 ms.
                    assert!(torque.is_finite() && found > 10.0 * limit && (0.005..0.008).contains(&t));
                }
                Ending::Diverged { reason: DivergenceError::Plant(PlantError::NotFinite { joint: 1, .. }), .. } => {
                    assert!(torque.is_nan());
                }
                other => panic!("{other:?}"),
            }
        }
    }
}
