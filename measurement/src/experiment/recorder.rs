//! An experiment whose samples are all kept in memory.

use std::ops::ControlFlow;

use super::arm::{Arm, ArmError, Ending, Flow, Sink};
use super::plan::ExperimentPlan;
use super::raw_sample::RawSample;
use super::recording::Recording;
use crate::observer::{Observer, Progress, Unobserved, Work};

/// A sink that keeps every sample of one experiment in memory.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    recording: Option<Recording>,
}

impl Recorder {
    /// What was recorded; `None` where no experiment began.
    pub fn into_recording(self) -> Option<Recording> {
        self.recording
    }
}

impl Sink for Recorder {
    fn begin(&mut self, recording: &Recording) {
        let mut recording = recording.clone();
        let samples = recording.phases.last().map_or(0, |span| span.samples.end);
        recording.t.reserve(samples);
        recording.q.reserve(samples * recording.dof);
        recording.effort.reserve(samples * recording.dof);
        self.recording = Some(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        if let Some(recording) = &mut self.recording {
            recording.push(sample);
        }
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
    let mut recorder = WatchedRecorder::new(plan, observer);
    let ending = arm.perform(plan, &mut recorder)?;
    let recording = recorder.into_recording().ok_or_else(|| ArmError::Unavailable {
        arm: "arm".to_owned(),
        reason: "it reports an ending, expected it to begin a recording first".to_owned(),
    })?;
    Ok((recording, ending))
}

/// A [`Recorder`] that stops the arm where an observer says so.
#[derive(Debug)]
pub struct WatchedRecorder<'a> {
    recorder: Recorder,
    observer: &'a dyn Observer,
    done: usize,
    total: usize,
}

impl<'a> WatchedRecorder<'a> {
    /// For the experiment of this plan.
    pub fn new(plan: &ExperimentPlan, observer: &'a dyn Observer) -> Self {
        // A plan that has no layout is refused before its first sample.
        let total = plan.layout().map_or(0, |layout| layout.samples());
        Self { recorder: Recorder::default(), observer, done: 0, total }
    }

    /// What was recorded; `None` where no experiment began.
    pub fn into_recording(self) -> Option<Recording> {
        self.recorder.into_recording()
    }
}

impl Sink for WatchedRecorder<'_> {
    fn begin(&mut self, recording: &Recording) {
        self.recorder.begin(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        let flow = self.recorder.sample(sample);
        self.done += 1;
        match self.observer.observe(Progress { work: Work::Samples, done: self.done, total: self.total }) {
            ControlFlow::Continue(()) => flow,
            ControlFlow::Break(()) => Flow::Stop,
        }
    }
}
