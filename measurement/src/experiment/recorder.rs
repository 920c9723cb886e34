//! An experiment whose samples are all kept in memory.

use super::arm::{Arm, ArmError, Ending, Flow, Sink};
use super::plan::ExperimentPlan;
use super::raw_sample::RawSample;
use super::recording::Recording;
use crate::observer::{Observer, Progress, Unobserved, Work};

/// A sink that keeps every sample of one experiment in memory, and stops the arm where an observer says so.
#[derive(Clone, Debug)]
pub struct Recorder<'a> {
    recording: Option<Recording>,
    observer: &'a dyn Observer,
}

impl<'a> Recorder<'a> {
    /// Reports every sample to this observer.
    pub const fn watched_by(observer: &'a dyn Observer) -> Self {
        Self { recording: None, observer }
    }

    /// What was recorded; `None` where no experiment began.
    pub fn into_recording(self) -> Option<Recording> {
        self.recording
    }
}

impl Sink for Recorder<'_> {
    fn begin(&mut self, recording: &Recording) {
        let mut recording = recording.clone();
        let samples = recording.planned_samples();
        recording.t.reserve(samples);
        recording.q.reserve(samples * recording.dof);
        recording.effort.reserve(samples * recording.dof);
        self.recording = Some(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        let Some(recording) = &mut self.recording else { return Flow::Continue };
        recording.push(sample);
        let (done, total) = (recording.len(), recording.planned_samples());
        let goes_on = self.observer.observe(Progress { work: Work::Samples, done, total }).is_continue();
        if goes_on { Flow::Continue } else { Flow::Stop }
    }
}

/// A sink that keeps nothing, for a run of which only the true states matter.
#[derive(Clone, Copy, Debug)]
pub struct Discarding;

impl Sink for Discarding {
    fn begin(&mut self, _: &Recording) {}

    fn sample(&mut self, _: &RawSample<'_>) -> Flow {
        Flow::Continue
    }
}

/// Performs a plan on an arm and keeps every sample in memory.
///
/// # Errors
/// [`ArmError`] where the experiment cannot begin, or has more samples than memory should hold.
pub fn record(arm: &mut dyn Arm, plan: &ExperimentPlan) -> Result<(Recording, Ending), ArmError> {
    record_watched(arm, plan, &Unobserved)
}

/// Records an experiment and reports to an observer, which may stop the arm: the samples up to there are kept.
///
/// # Errors
/// As [`record`].
pub fn record_watched(
    arm: &mut dyn Arm,
    plan: &ExperimentPlan,
    observer: &dyn Observer,
) -> Result<(Recording, Ending), ArmError> {
    plan.check_held()?;
    let mut recorder = Recorder::watched_by(observer);
    let ending = arm.perform(plan, &mut recorder)?;
    let recording = recorder.into_recording().ok_or_else(|| ArmError::Unavailable {
        arm: "arm".to_owned(),
        reason: "it reports an ending, expected it to begin a recording first".to_owned(),
    })?;
    Ok((recording, ending))
}
