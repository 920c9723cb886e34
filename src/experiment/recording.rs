//! What an experiment leaves behind: raw samples, and everything needed to read them.

use std::ops::Range;

use super::{Arm, ArmError, Ending, ExperimentPlan, Flow, Phase, PhaseSpan, RawSample, Sink};
use crate::excitation::PeriodicTrajectory;
use crate::model::EffortInterface;
use crate::provenance::Provenance;

/// The raw samples of one experiment. N samples, n joints; tables are row-major, sample after sample.
///
/// There are no gaps: where an arm loses a sample, the values of the one before stand at its place, under the stamp that
/// it should have had.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name of the robot.
    pub robot: String,
    /// Text of the robot file; empty where the robot came from somewhere else.
    pub robot_text: String,
    /// Number of joints n.
    pub dof: usize,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Names of the joints, n.
    pub joints: Vec<String>,
    /// What `effort` is: motor current in A, or joint torque in N·m (N).
    pub effort_unit: EffortInterface,
    /// The phases in order, with their samples; as planned, and so past N where an experiment ended early.
    pub phases: Vec<PhaseSpan>,
    /// The commanded periodic motion.
    pub trajectory: PeriodicTrajectory,
    /// Samples in one period of the motion.
    pub period_samples: usize,
    /// Time of each sample since the beginning of the experiment, s; N.
    pub t: Vec<f64>,
    /// Joint coordinates from the encoders, rad (m); N × n.
    pub q: Vec<f64>,
    /// What the robot reports as effort, in `effort_unit`; N × n.
    pub effort: Vec<f64>,
    /// Voltages at the motors' terminals, V; N × n, or empty where the interface gives none.
    pub voltage: Vec<f64>,
    /// What produced it.
    pub provenance: Provenance,
}

impl Recording {
    /// Number of samples N.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether it has no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Joint coordinates of sample `k`, n.
    #[must_use]
    pub fn q(&self, k: usize) -> &[f64] {
        &self.q[k * self.dof..(k + 1) * self.dof]
    }

    /// Effort of sample `k`, n.
    #[must_use]
    pub fn effort(&self, k: usize) -> &[f64] {
        &self.effort[k * self.dof..(k + 1) * self.dof]
    }

    /// Motor voltages of sample `k`, n, or none.
    #[must_use]
    pub fn voltage(&self, k: usize) -> &[f64] {
        self.voltage.get(k * self.dof..(k + 1) * self.dof).unwrap_or_default()
    }

    /// The same recording without its samples.
    #[must_use]
    pub fn without_samples(&self) -> Self {
        let mut header = self.clone();
        header.truncate(0);
        header
    }

    /// The same recording with its first `samples` samples.
    pub fn truncate(&mut self, samples: usize) {
        let n = self.dof;
        self.t.truncate(samples);
        self.q.truncate(samples * n);
        self.effort.truncate(samples * n);
        self.voltage.truncate(samples * n);
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: &RawSample<'_>) {
        self.t.push(sample.t);
        self.q.extend_from_slice(sample.q);
        self.effort.extend_from_slice(sample.effort);
        self.voltage.extend_from_slice(sample.voltage);
    }

    /// The samples of a phase that were really taken.
    #[must_use]
    pub fn samples(&self, phase: Phase) -> Range<usize> {
        let planned = self.phases.iter().find(|span| span.phase == phase).map_or(0..0, |span| span.samples.clone());
        planned.start.min(self.len())..planned.end.min(self.len())
    }

    /// The samples of the periods that count.
    #[must_use]
    pub fn recorded(&self) -> Range<usize> {
        self.samples(Phase::Record)
    }

    /// Whole periods that were recorded.
    #[must_use]
    pub fn periods(&self) -> usize {
        self.recorded().len().checked_div(self.period_samples).unwrap_or(0)
    }

    /// The samples of the recorded period `p`, from zero.
    #[must_use]
    pub fn period(&self, p: usize) -> Range<usize> {
        let start = self.recorded().start + p * self.period_samples;
        start..start + self.period_samples
    }

    /// The phase of sample `k`.
    #[must_use]
    pub fn phase(&self, k: usize) -> Option<Phase> {
        self.phases.iter().find(|span| span.samples.contains(&k)).map(|span| span.phase)
    }
}

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
/// [`ArmError`] where the experiment cannot begin.
pub fn record(arm: &mut dyn Arm, plan: &ExperimentPlan) -> Result<(Recording, Ending), ArmError> {
    let mut recorder = Recorder::default();
    let ending = arm.perform(plan, &mut recorder)?;
    let recording = recorder.into_recording().ok_or_else(|| ArmError::Unavailable {
        arm: "arm".to_owned(),
        reason: "it reports an ending, expected it to begin a recording first".to_owned(),
    })?;
    Ok((recording, ending))
}
