//! What an experiment leaves behind: raw samples, and everything needed to read them.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::layout::Layout;
use super::phase::{Phase, PhaseSpan};
use super::plan::ExperimentPlan;
use super::raw_sample::RawSample;
use crate::model::{EffortInterface, Robot};
use crate::provenance::Provenance;
use crate::seed::Seed;
use crate::trajectory::PeriodicTrajectory;

/// The raw samples of one experiment. N samples, n joints; tables are row-major, sample after sample.
///
/// There are no gaps: where an arm loses a sample, the values of the one before stand at its place, under the stamp that
/// it should have had.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
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
    /// Joint coordinates by encoders behind the transmissions, rad (m); N × n, or empty where there are none.
    #[serde(default)]
    pub link_q: Vec<f64>,
    /// What produced it.
    pub provenance: Provenance,
}

crate::plain::checked_when_read!(Recording, |value| value.check().map(|()| value));

impl Recording {
    /// A recording of a plan before its first sample, of a robot whose file has this text.
    pub fn empty(robot: &Robot, robot_text: &str, plan: &ExperimentPlan, layout: &Layout, seed: Option<Seed>) -> Self {
        Self {
            robot: robot.name().to_owned(),
            robot_text: robot_text.to_owned(),
            dof: robot.dof(),
            rate_hz: plan.rate_hz,
            joints: robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            effort_unit: robot.effort(),
            phases: layout.spans.clone(),
            trajectory: plan.trajectory.clone(),
            period_samples: layout.period_samples,
            t: Vec::new(),
            q: Vec::new(),
            effort: Vec::new(),
            voltage: Vec::new(),
            link_q: Vec::new(),
            provenance: Provenance::new(robot.name(), robot_text, seed),
        }
    }

    /// Checks that tables have the size that they say, and that phases follow each other.
    ///
    /// # Errors
    /// What was found and what was expected.
    pub fn check(&self) -> Result<(), String> {
        let (n, samples) = (self.dof, self.t.len());
        let sizes = [
            ("joints", self.joints.len(), n),
            ("q", self.q.len(), samples * n),
            ("effort", self.effort.len(), samples * n),
            ("trajectory", self.trajectory.dof(), n),
        ];
        if let Some((what, found, expected)) = sizes.into_iter().find(|(_, found, expected)| found != expected) {
            return Err(format!("{what} has {found} entries, expected {expected} for {samples} samples of {n} joints"));
        }
        for (what, found) in [("voltage", self.voltage.len()), ("link_q", self.link_q.len())] {
            if found != 0 && found != samples * n {
                return Err(format!("{what} has {found} entries, expected none or {}", samples * n));
            }
        }
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) || self.period_samples == 0 {
            let (rate, period) = (self.rate_hz, self.period_samples);
            return Err(format!("rate_hz is {rate} and period_samples {period}, expected both above zero"));
        }
        let mut begin = 0;
        for span in &self.phases {
            let Range { start, end } = span.samples;
            if start != begin || end < start {
                let name = span.phase.name();
                return Err(format!("phase {name} is samples {start} to {end}, expected it to begin at {begin}"));
            }
            begin = end;
        }
        Ok(())
    }

    /// Number of samples N.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether it has no samples.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Joint coordinates of sample `k`, n.
    pub fn q(&self, k: usize) -> &[f64] {
        &self.q[k * self.dof..(k + 1) * self.dof]
    }

    /// Effort of sample `k`, n.
    pub fn effort(&self, k: usize) -> &[f64] {
        &self.effort[k * self.dof..(k + 1) * self.dof]
    }

    /// Motor voltages of sample `k`, n, or none.
    pub fn voltage(&self, k: usize) -> &[f64] {
        self.voltage.get(k * self.dof..(k + 1) * self.dof).unwrap_or_default()
    }

    /// Positions behind the transmissions of sample `k`, n, or none.
    pub fn link_q(&self, k: usize) -> &[f64] {
        self.link_q.get(k * self.dof..(k + 1) * self.dof).unwrap_or_default()
    }

    /// Returns this recording without its samples.
    #[must_use]
    pub fn without_samples(&self) -> Self {
        let mut header = self.clone();
        header.truncate(0);
        header
    }

    /// Keeps the first `samples` samples of this recording.
    pub fn truncate(&mut self, samples: usize) {
        let n = self.dof;
        self.t.truncate(samples);
        self.q.truncate(samples * n);
        self.effort.truncate(samples * n);
        self.voltage.truncate(samples * n);
        self.link_q.truncate(samples * n);
    }

    /// Leaves out every recorded period that holds one of these samples, as if it had not been performed. Returns which
    /// those were, from zero.
    pub fn leave_out(&mut self, samples: &[usize]) -> Vec<usize> {
        let touched: Vec<usize> =
            (0..self.periods()).filter(|&p| samples.iter().any(|sample| self.period(p).contains(sample))).collect();
        let n = self.dof;
        for &p in touched.iter().rev() {
            let period = self.period(p);
            let rows = period.start * n..period.end * n;
            self.q.drain(rows.clone());
            self.effort.drain(rows.clone());
            for table in [&mut self.voltage, &mut self.link_q] {
                if !table.is_empty() {
                    table.drain(rows.clone());
                }
            }
            // Time goes on without a step.
            self.t.truncate(self.t.len() - period.len());
            let mut after = false;
            for span in &mut self.phases {
                span.samples.start -= if after { period.len() } else { 0 };
                after |= span.phase == Phase::Record;
                span.samples.end -= if after { period.len() } else { 0 };
            }
        }
        touched
    }

    /// Samples of the whole experiment, as planned.
    pub(super) fn planned_samples(&self) -> usize {
        self.phases.last().map_or(0, |span| span.samples.end)
    }

    /// Sample k as the arm reported it in a phase, and what was commanded then.
    pub(super) fn sample<'a>(&'a self, k: usize, phase: Phase, command: &'a [f64]) -> RawSample<'a> {
        let (q, effort, voltage, link_q) = (self.q(k), self.effort(k), self.voltage(k), self.link_q(k));
        RawSample { index: k, t: self.t[k], phase, q, effort, voltage, link_q, command }
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: &RawSample<'_>) {
        self.t.push(sample.t);
        self.q.extend_from_slice(sample.q);
        self.effort.extend_from_slice(sample.effort);
        self.voltage.extend_from_slice(sample.voltage);
        self.link_q.extend_from_slice(sample.link_q);
    }

    /// The samples of a phase, taken or not.
    pub(super) fn planned(&self, phase: Phase) -> Range<usize> {
        self.phases.iter().find(|span| span.phase == phase).map_or(0..0, |span| span.samples.clone())
    }

    /// The samples of a phase that were really taken.
    pub fn samples(&self, phase: Phase) -> Range<usize> {
        let planned = self.planned(phase);
        planned.start.min(self.len())..planned.end.min(self.len())
    }

    /// The samples of the periods that count.
    pub fn recorded(&self) -> Range<usize> {
        self.samples(Phase::Record)
    }

    /// Whole periods that were recorded.
    pub fn periods(&self) -> usize {
        self.recorded().len().checked_div(self.period_samples).unwrap_or(0)
    }

    /// The samples of the recorded period `p`, from zero.
    pub fn period(&self, p: usize) -> Range<usize> {
        let start = self.recorded().start + p * self.period_samples;
        start..start + self.period_samples
    }

    /// The plan that it was made by, as far as its phases tell.
    pub fn plan(&self) -> ExperimentPlan {
        let length = |phase: Phase| self.planned(phase).len();
        let period = self.period_samples.max(1);
        ExperimentPlan {
            trajectory: self.trajectory.clone(),
            rate_hz: self.rate_hz,
            settle_s: length(Phase::Settle) as f64 / self.rate_hz,
            ramp_s: length(Phase::RampIn) as f64 / self.rate_hz,
            discarded_periods: length(Phase::Discard) / period,
            periods: length(Phase::Record) / period,
        }
    }

    /// The phase of sample `k`.
    pub fn phase(&self, k: usize) -> Option<Phase> {
        self.phases.iter().find(|span| span.samples.contains(&k)).map(|span| span.phase)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ExperimentPlan, Servo, record};

    #[test]
    fn identity_what_is_left_without_a_period_is_the_others() {
        let plan =
            ExperimentPlan { settle_s: 0.1, ramp_s: 0.3, periods: 4, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let mut servo = Servo::new(&hinges::single(), &hinges::parameters(1), FlyWheels::new(1)).unwrap();
        let whole = record(&mut servo, &plan).unwrap().0;
        assert_eq!(whole.plan(), plan);
        let mut less = whole.clone();
        // Before the periods that count, in the second, at the ends of the fourth, and after them.
        let touched =
            [0, whole.period(1).start + 7, whole.period(3).start, whole.period(3).end - 1, whole.period(3).end];
        assert_eq!(less.leave_out(&touched), [1, 3]);
        assert_eq!((less.periods(), less.len()), (2, whole.len() - 2 * whole.period_samples));
        assert_eq!(less.plan(), plan.clone().with_periods(2));
        for (kept, p) in [(0, 0), (1, 2)] {
            assert_eq!(less.q[less.period(kept)], whole.q[whole.period(p)]);
            assert_eq!(less.effort[less.period(kept)], whole.effort[whole.period(p)]);
        }
        for phase in [Phase::Settle, Phase::RampIn, Phase::RampOut] {
            assert_eq!(less.q[less.samples(phase)], whole.q[whole.samples(phase)], "{phase:?}");
        }
        assert_eq!(less.t, whole.t[..less.len()]);
        assert_eq!(whole.clone().leave_out(&[]), [0; 0]);
    }
}
