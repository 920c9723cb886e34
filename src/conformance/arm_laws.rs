//! What every arm obeys, simulated, replayed or real.
//!
//! - a recording is announced once, before its samples, and says what the plan says;
//! - samples come in the order of time, one for every tick of the plan, in the plan's phases, every value finite;
//! - the arm follows its command while it counts;
//! - when the sink says stop, no sample follows, and the ending says so;
//! - a plan that cannot be performed is refused before anything is announced.

use super::law_error::LawError;
use crate::experiment::{Arm, Ending, ExperimentPlan, Flow, Layout, Phase, RawSample, Recording, Sink};
use crate::trajectory::{FourierJoint, FourierTrajectory};

/// What may be asked of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmTolerance {
    /// Largest distance from the command in a recorded period, rad (m).
    pub tracking: f64,
    /// Largest distance of a time stamp from its tick, in ticks.
    pub jitter: f64,
    /// Whether two experiments are the same to the last bit.
    pub repeatable: bool,
}

impl ArmTolerance {
    /// A simulated arm that follows within 0.05 rad.
    pub const SIMULATED: Self = Self { tracking: 0.05, jitter: 1e-9, repeatable: true };
}

/// Checks one arm on one plan that it can perform.
///
/// ```text
/// arm_laws::check(&plan, &ArmTolerance::SIMULATED, || servo.clone())?
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check<A: Arm>(plan: &ExperimentPlan, tolerance: &ArmTolerance, make: impl Fn() -> A) -> Result<(), LawError> {
    let law = "an experiment ends as planned";
    let whole = perform(law, &mut make(), plan, usize::MAX)?;
    let (samples_found, planned) = (whole.recording.len(), whole.layout.samples());
    let found = format!("{:?} after {samples_found} samples", whole.ending);
    let ended = whole.ending == Ending::Completed && samples_found == planned;
    LawError::unless(law, ended, found, format!("Completed after {planned} samples"))?;
    announcement(plan, &whole)?;
    samples(plan, tolerance, &whole)?;
    if tolerance.repeatable {
        let law = "an experiment can be repeated";
        let again = perform(law, &mut make(), plan, usize::MAX)?;
        LawError::unless(law, again.recording == whole.recording, "another recording", "the same bits")?;
    }
    stopping(plan, &make)?;
    refusal(plan, &make)
}

/// Receives everything and judges nothing.
#[derive(Default)]
struct Witness {
    announced: usize,
    early: bool,
    recording: Option<Recording>,
    phases: Vec<Phase>,
    indices: Vec<usize>,
    tracking: f64,
    until: usize,
}

impl Sink for Witness {
    fn begin(&mut self, recording: &Recording) {
        self.announced += 1;
        self.recording = Some(recording.clone());
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        let Some(recording) = &mut self.recording else {
            self.early = true;
            return Flow::Stop;
        };
        recording.t.push(sample.t);
        recording.q.extend_from_slice(sample.q);
        recording.effort.extend_from_slice(sample.effort);
        self.phases.push(sample.phase);
        self.indices.push(sample.index);
        if sample.phase == Phase::Record {
            for (q, command) in sample.q.iter().zip(sample.command) {
                self.tracking = self.tracking.max((q - command).abs());
            }
        }
        if self.indices.len() < self.until { Flow::Continue } else { Flow::Stop }
    }
}

struct Received {
    layout: Layout,
    ending: Ending,
    recording: Recording,
    seen: Witness,
}

fn perform(law: &'static str, arm: &mut dyn Arm, plan: &ExperimentPlan, until: usize) -> Result<Received, LawError> {
    let fault = |found: String, expected: &'static str| LawError { law, found, expected: expected.into() };
    let layout = plan.layout().map_err(|e| fault(e.to_string(), "a plan that can be performed"))?;
    let mut witness = Witness { until, ..Witness::default() };
    let ending = arm.perform(plan, &mut witness).map_err(|e| fault(e.to_string(), "an experiment"))?;
    let law = "a recording is announced once, before its samples";
    LawError::unless(
        law,
        witness.announced == 1 && !witness.early,
        format!("{} announcements", witness.announced),
        "one",
    )?;
    let recording = witness.recording.take().ok_or_else(|| fault("none".to_owned(), "a recording"))?;
    Ok(Received { layout, ending, recording, seen: witness })
}

fn announcement(plan: &ExperimentPlan, received: &Received) -> Result<(), LawError> {
    let law = "a recording says what the plan says";
    let recording = &received.recording;
    let n = plan.trajectory.dof();
    LawError::unless(law, recording.dof == n, recording.dof.to_string(), format!("{n} joints"))?;
    LawError::unless(law, recording.joints.len() == n, format!("{:?}", recording.joints), format!("{n} names"))?;
    LawError::unless_at_most(law, (recording.rate_hz - plan.rate_hz).abs(), 1e-9 * plan.rate_hz)?;
    let (found, expected) = (recording.period_samples, received.layout.period_samples);
    LawError::unless(law, found == expected, format!("{found} samples"), format!("{expected} in a period"))?;
    LawError::unless(
        law,
        recording.periods() == plan.periods,
        format!("{} periods", recording.periods()),
        format!("{} recorded periods", plan.periods),
    )?;
    LawError::unless(law, recording.trajectory == plan.trajectory, "another trajectory", "the plan's")
}

fn samples(plan: &ExperimentPlan, tolerance: &ArmTolerance, received: &Received) -> Result<(), LawError> {
    let law = "samples come one per tick in the plan's phases";
    let recording = &received.recording;
    let total = recording.len();
    let lengths = (recording.q.len(), recording.effort.len());
    let expected = total * recording.dof;
    LawError::unless(law, lengths == (expected, expected), format!("{lengths:?} values"), expected.to_string())?;
    for k in 0..total {
        LawError::unless(
            law,
            received.seen.indices[k] == k,
            format!("index {}", received.seen.indices[k]),
            k.to_string(),
        )?;
        let tick = (recording.t[k] * plan.rate_hz - k as f64).abs();
        LawError::unless_at_most(law, tick, tolerance.jitter.max(1e-12 * k as f64))?;
        let (found, expected) = (received.seen.phases[k], received.layout.phase(k));
        LawError::unless(law, found == expected, found.name(), expected.name())?;
    }
    let finite = recording.q.iter().chain(&recording.effort).all(|x| x.is_finite());
    LawError::unless("every value is finite", finite, "one that is not", "finite numbers")?;
    LawError::unless_at_most("the arm follows its command", received.seen.tracking, tolerance.tracking)
}

fn stopping<A: Arm>(plan: &ExperimentPlan, make: &impl Fn() -> A) -> Result<(), LawError> {
    let law = "when the sink says stop no sample follows";
    let until = plan.layout().map_or(1, |layout| layout.samples() / 2).max(1);
    let received = perform(law, &mut make(), plan, until)?;
    let found = received.recording.len();
    LawError::unless(law, found == until, format!("{found} samples"), until.to_string())?;
    let said = matches!(&received.ending, Ending::Stopped { phase, .. } if *phase == received.layout.phase(until - 1));
    LawError::unless(law, said, format!("{:?}", received.ending), "Stopped in the phase of the last sample")
}

fn refusal<A: Arm>(plan: &ExperimentPlan, make: &impl Fn() -> A) -> Result<(), LawError> {
    let law = "a plan that cannot be performed is refused before anything is announced";
    let still = |j: usize| FourierJoint { name: format!("extra{j}"), a: vec![0.0], b: vec![0.0], q0: 0.0 };
    let joints = (0..=plan.trajectory.dof()).map(still).collect();
    let wide = FourierTrajectory { period_s: plan.trajectory.period_s(), joints };
    let wide = ExperimentPlan { trajectory: wide.into(), ..plan.clone() };
    let never = ExperimentPlan { periods: 0, ..plan.clone() };
    let between = ExperimentPlan { rate_hz: plan.rate_hz * 0.999_77, ..plan.clone() };
    for impossible in [wide, never, between] {
        let mut witness = Witness { until: 1, ..Witness::default() };
        let answer = make().perform(&impossible, &mut witness);
        LawError::unless(law, answer.is_err(), format!("{answer:?}"), "an error")?;
        LawError::unless(law, witness.announced == 0, "an announcement", "none")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{Replay, Servo, record};
    use crate::seed::Seed;

    #[test]
    fn servo_and_replay_obey_the_laws_of_arms() {
        let plan =
            ExperimentPlan { settle_s: 0.2, ramp_s: 0.5, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) };
        let robot = hinges::coupled();
        let servo =
            || Servo::new(&robot, &hinges::parameters(2), FlyWheels::new(2)).unwrap().with_seed(Seed::new(6), 1);
        check(&plan, &ArmTolerance::SIMULATED, servo).unwrap();
        let recording = record(&mut servo(), &plan).unwrap().0;
        check(&plan, &ArmTolerance::SIMULATED, || Replay(recording.clone())).unwrap();
    }
}
