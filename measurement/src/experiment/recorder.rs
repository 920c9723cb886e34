//! An experiment whose samples are all kept in memory.

use super::arm::{Arm, ArmError, Ending, Flow, Sink};
use super::plan::ExperimentPlan;
use super::raw_sample::RawSample;
use super::recording::Recording;

/// A sink that keeps every sample of one experiment in memory.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    recording: Option<Recording>,
}

impl Recorder {
    /// What was recorded; `None` where no experiment began.
    #[must_use]
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
    plan.check_held()?;
    let mut recorder = Recorder::default();
    let ending = arm.perform(plan, &mut recorder)?;
    let recording = recorder.into_recording().ok_or_else(|| ArmError::Unavailable {
        arm: "arm".to_owned(),
        reason: "it reports an ending, expected it to begin a recording first".to_owned(),
    })?;
    Ok((recording, ending))
}
