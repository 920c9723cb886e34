//! An experiment that was cut short, continued at the next period.
//!
//! ```text
//! first    settle → ramp in → discard → period 1 … k │ cut
//! second   settle → ramp in → discard →              │ period k+1 … P → ramp out
//! joined   settle → ramp in → discard → period 1 … k │ period k+1 … P → ramp out
//! ```
//! The arm comes to the motion again as it did the first time, so that its transient has decayed before the missing
//! periods; that second approach is performed and not kept. The joined recording has the phases and the times of the
//! whole plan.

use super::arm::{Flow, Sink};
use super::command::Command;
use super::layout::Layout;
use super::phase::Phase;
use super::plan::ExperimentPlan;
use super::plan_error::PlanError;
use super::plan_mismatch::PlanMismatchError;
use super::raw_sample::RawSample;
use super::recording::Recording;

/// What is kept of a recording that was cut short, and what is still missing of its plan.
#[derive(Clone, Debug)]
pub struct Continuation {
    plan: ExperimentPlan,
    layout: Layout,
    kept: Recording,
    periods: usize,
}

/// Why a recording cannot be continued by a plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContinuationError {
    /// The plan cannot be performed at all.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The recording is of another experiment.
    #[error(transparent)]
    Mismatch(#[from] PlanMismatchError),
}

impl Continuation {
    /// Keeps the whole recorded periods of `cut`, at most those that `plan` asks for.
    ///
    /// # Errors
    /// [`ContinuationError`] where the plan cannot be performed, or the recording has another motion, rate or other
    /// phases ahead of its periods.
    pub fn new(plan: &ExperimentPlan, mut cut: Recording) -> Result<Self, ContinuationError> {
        let layout = plan.check(cut.dof)?;
        if (cut.rate_hz - plan.rate_hz).abs() > 1e-9 * plan.rate_hz {
            return Err(PlanMismatchError::Rate { found: cut.rate_hz, planned: plan.rate_hz }.into());
        }
        if cut.trajectory != plan.trajectory {
            return Err(PlanMismatchError::Trajectory.into());
        }
        for span in layout.spans.iter().filter(|span| span.phase < Phase::Record) {
            let (found, planned) = (cut.planned(span.phase), span.samples.clone());
            if found != planned {
                return Err(PlanMismatchError::Span { phase: span.phase, found, planned }.into());
            }
        }
        cut.phases.clone_from(&layout.spans);
        let periods = cut.periods().min(plan.periods);
        let samples = if periods == 0 { 0 } else { cut.period(periods - 1).end };
        cut.truncate(samples);
        Ok(Self { plan: plan.clone(), layout, kept: cut, periods })
    }

    /// Periods that are kept.
    pub const fn periods(&self) -> usize {
        self.periods
    }

    /// Samples that are kept.
    pub fn samples(&self) -> usize {
        self.kept.len()
    }

    /// What is still to be performed; `None` where no period is missing.
    pub fn rest(&self) -> Option<ExperimentPlan> {
        let missing = self.plan.periods - self.periods;
        (missing > 0).then(|| self.plan.clone().with_periods(missing))
    }

    /// A sink for the arm that performs the rest; `whole` receives the joined experiment, the kept samples first.
    pub fn join<'a>(&'a self, whole: &'a mut dyn Sink) -> Joined<'a> {
        Joined { continuation: self, whole, flow: Flow::Continue }
    }

    /// Hands the kept samples to a sink, as [`Continuation::join`] does before the first new one.
    pub fn replay_kept(&self, sink: &mut dyn Sink) -> Flow {
        let kept = &self.kept;
        sink.begin(&kept.without_samples());
        let command = Command::new(&self.plan, &self.layout);
        let n = kept.dof;
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..kept.len() {
            command.evaluate(kept.t[k], &mut q, &mut qd, &mut qdd);
            let flow = sink.sample(&kept.sample(k, self.layout.phase(k), &q));
            if flow.ends() {
                return flow;
            }
        }
        Flow::Continue
    }
}

/// The sink that moves the samples of the second part to where they belong in the whole.
pub struct Joined<'a> {
    continuation: &'a Continuation,
    whole: &'a mut dyn Sink,
    flow: Flow,
}

impl Sink for Joined<'_> {
    fn begin(&mut self, _: &Recording) {
        self.flow = self.continuation.replay_kept(self.whole);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        if self.flow.ends() {
            return self.flow;
        }
        // Without a kept period nothing was kept, and the second part is the whole.
        let kept = self.continuation.periods;
        if kept > 0 && sample.phase < Phase::Record {
            return Flow::Continue;
        }
        let index = sample.index + kept * self.continuation.layout.period_samples;
        let t = index as f64 / self.continuation.plan.rate_hz;
        let t = if kept > 0 { t } else { sample.t };
        self.flow = self.whole.sample(&RawSample { index, t, ..*sample });
        self.flow
    }

    fn unrecorded(&mut self, sample: &RawSample<'_>) -> Flow {
        self.whole.unrecorded(sample)
    }

    fn idle(&mut self, age_s: f64) -> Flow {
        self.whole.idle(age_s)
    }

    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        self.whole.command(set_point, age_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{Arm, Recorder, Servo, record};
    use crate::observer::Unobserved;
    use crate::seed::Seed;

    fn plan(periods: usize) -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.2, ramp_s: 0.5, periods, ..ExperimentPlan::new(hinges::trajectory(2)) }
    }

    fn servo(run: u64) -> Servo<FlyWheels> {
        let robot = hinges::coupled();
        Servo::new(&robot, &hinges::parameters(2), FlyWheels::new(2)).unwrap().with_seed(Seed::new(6), run)
    }

    fn cut(recording: &Recording, samples: usize) -> Recording {
        let mut cut = recording.clone();
        cut.truncate(samples);
        cut
    }

    /// The whole experiment, of which a run of the servo performs the rest.
    fn performed(continuation: &Continuation, run: u64) -> Recording {
        let mut recorder = Recorder::watched_by(&Unobserved);
        if let Some(rest) = continuation.rest() {
            assert!(servo(run).perform(&rest, &mut continuation.join(&mut recorder)).unwrap().is_complete());
        } else {
            continuation.replay_kept(&mut recorder);
        }
        recorder.into_recording().unwrap()
    }

    #[test]
    fn identity_joined_periods_are_the_first_s_and_then_the_second_s() {
        let (first, _) = record(&mut servo(0), &plan(4)).unwrap();
        let (second, _) = record(&mut servo(1), &plan(2)).unwrap();
        let continuation = Continuation::new(&plan(4), cut(&first, first.period(2).start + 17)).unwrap();
        assert_eq!((continuation.periods(), continuation.rest().unwrap().periods), (2, 2));
        let joined = performed(&continuation, 1);
        assert_eq!((joined.len(), joined.periods()), (first.len(), 4));
        assert_eq!((&joined.phases, &joined.t), (&first.phases, &first.t));
        let until = first.period(1).end;
        assert_eq!(joined.effort[..2 * until], first.effort[..2 * until]);
        let from = second.period(0).start;
        assert_eq!(joined.effort[2 * until..], second.effort[2 * from..]);
        assert_eq!(joined.q[2 * until..], second.q[2 * from..]);
    }

    #[test]
    fn before_the_first_whole_period_it_begins_again_and_after_the_last_nothing_is_performed() {
        let (first, _) = record(&mut servo(0), &plan(2)).unwrap();
        let early = Continuation::new(&plan(2), cut(&first, first.period(0).end - 1)).unwrap();
        assert_eq!((early.periods(), early.samples()), (0, 0));
        assert_eq!(performed(&early, 0), first);

        let late = Continuation::new(&plan(2), cut(&first, first.len() - 3)).unwrap();
        assert!(late.rest().is_none());
        let kept = performed(&late, 0);
        assert_eq!((kept.periods(), kept.len()), (2, first.period(1).end));
    }

    #[test]
    fn another_experiment_is_refused() {
        let (first, _) = record(&mut servo(0), &plan(2)).unwrap();
        let mut other = plan(2);
        other.trajectory.adjust(0, 1.0, 0.1);
        for (plan, word) in [
            (ExperimentPlan { rate_hz: 500.0, ..plan(2) }, "rate_hz is 1000"),
            (other, "trajectory"),
            (ExperimentPlan { ramp_s: 1.0, ..plan(2) }, "ramp-in is samples 200 to 700"),
        ] {
            let message = Continuation::new(&plan, first.clone()).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
