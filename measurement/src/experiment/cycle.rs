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
    pub(super) timing: Timing,
    names: Vec<String>,
    /// Ten times the speed limits.
    pub(super) runaway: Vec<f64>,
    pub(super) joints: JointLoop,
    clock: Option<SampleClock>,
    slips: Option<ClockSlips>,
    tracking: Tracking,
    pub(super) place: Place,
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

/// How far an experiment has come: servo steps, samples, spans of its layout.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub(super) step: usize,
    sample: usize,
    span: usize,
}

impl Place {
    /// Whether a sample is due at the next step; `None` at the end of the experiment.
    pub(super) fn begin(&mut self, timing: &Timing) -> Option<bool> {
        // One is usual, and spares the division.
        let due = timing.per_sample == 1 || self.step.is_multiple_of(timing.per_sample);
        let spans = &timing.layout.spans;
        while due && spans.get(self.span).is_some_and(|span| self.sample >= span.samples.end) {
            self.span += 1;
        }
        (self.span < spans.len()).then_some(due)
    }

    /// What the arm is doing: at the end, what it did last.
    fn phase(&self, timing: &Timing) -> Phase {
        timing.layout.spans.get(self.span).map_or(Phase::RampOut, |span| span.phase)
    }

    /// What is commanded at this step, n.
    pub(super) fn command<'a>(&self, timing: &'a Timing) -> &'a [f64] {
        timing.table.row(self.step)
    }

    /// Position and time of the next sample, s.
    fn next_sample(&self, timing: &Timing) -> (usize, f64) {
        (self.sample, self.sample as f64 / timing.rate_hz)
    }

    /// Goes on after a step under `command`, and hands its sample on where there is one; returns an ending where the sink stops the arm.
    pub(super) fn finish(
        &mut self,
        timing: &Timing,
        command: &[f64],
        reported: Option<[&[f64]; 4]>,
        sink: &mut dyn Sink,
    ) -> Option<Ending> {
        let phase = self.phase(timing);
        self.step += 1;
        let [q, effort, voltage, link_q] = reported?;
        let (index, t) = self.next_sample(timing);
        self.sample += 1;
        let flow = sink.sample(&RawSample { index, t, phase, q, effort, voltage, link_q, command });
        flow.ends().then_some(Ending::Stopped { t, phase, rest: Rest::Simulated })
    }
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
            place: Place::default(),
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
        let Some(due) = self.place.begin(&self.timing) else { return Next::End(self.end(Ending::Completed)) };
        if let Some(ending) = self.runaway(q, qd) {
            return Next::End(ending);
        }
        let (command, phase) = (self.place.command(&self.timing), self.place.phase(&self.timing));
        let saturated = self.joints.step(command, q, qd);
        self.tracking.saturated_steps += usize::from(saturated);
        if phase == Phase::Record {
            self.tracking.add(command, q, self.joints.tau(), self.joints.current());
        }
        let mut reported = None;
        if due {
            let (index, t) = self.place.next_sample(&self.timing);
            // At the time that the sample is stamped with, unless the clock says otherwise. Where it is lost, the one before
            // stands in its place.
            let (late_s, lost) = self.clock.as_mut().map_or((0.0, false), |clock| (clock.lateness(), clock.loses()));
            self.joints.sense_late(late_s, lost);
            observer(&TrueState { index, t, phase, q, qd, tau: self.joints.tau() });
            let values = self.joints.reported();
            reported = Some(match &mut self.slips {
                None => values,
                Some(slips) => slips.written(values),
            });
        }
        match self.place.finish(&self.timing, command, reported, sink) {
            Some(ending) => Next::End(self.end(ending)),
            None => Next::Step,
        }
    }

    /// Ends the experiment because the plant failed.
    pub fn fail(&mut self, fault: PlantError) -> Ending {
        self.diverge(DivergenceError::Plant(fault))
    }

    fn diverge(&mut self, reason: DivergenceError) -> Ending {
        let (t, phase) = (self.place.step as f64 * self.dt(), self.place.phase(&self.timing));
        self.end(Ending::Diverged { t, phase, reason })
    }

    pub(super) fn end(&mut self, ending: Ending) -> Ending {
        self.tracking.finish();
        ending
    }

    /// Ends the experiment where the plant is at no finite state, or runs away.
    pub(super) fn runaway(&mut self, q: &[f64], qd: &[f64]) -> Option<Ending> {
        if let Some(fault) = PlantError::of_state(q, qd) {
            return Some(self.fail(fault));
        }
        let i = qd.iter().zip(&self.runaway).position(|(qd, limit)| qd.abs() > *limit)?;
        let (joint, limit) = (self.names[i].clone(), self.runaway[i] / 10.0);
        Some(self.diverge(DivergenceError::Speed { joint, found: qd[i].abs(), limit }))
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
