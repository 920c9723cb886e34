//! What performs an experiment, simulated or real, and where its samples go.

use super::expectation::Expectation;
use super::phase::Phase;
use super::plan::ExperimentPlan;
use super::plan_error::PlanError;
use super::plan_mismatch::PlanMismatchError;
use super::plant::PlantError;
use super::raw_sample::RawSample;
use super::received_state::ReceivedState;
use super::recording::Recording;
use super::trip::{Rest, SafeAction, TripReport};

/// An arm that performs experiments: a servo around a simulated plant, a real robot, or a stored recording.
///
/// Laws that every arm obeys are in `conformance::arm_laws`.
pub trait Arm: Send {
    /// Performs a plan from beginning to end, or until the sink asks to stop.
    ///
    /// `sink` gets [`Sink::begin`] once, before the first sample, and then every sample in the order of time. An arm in
    /// real time also passes on what is no part of the experiment, before it and in between ([`Sink::unrecorded`]).
    ///
    /// # Errors
    /// [`ArmError`] where the experiment cannot begin. One that begins and fails has an [`Ending`] that says how,
    /// and its samples up to there count.
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError>;
}

impl<A: Arm + ?Sized> Arm for Box<A> {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        (**self).perform(plan, sink)
    }
}

/// Where samples go: into memory, into a file, into a running average.
pub trait Sink {
    /// Receives what is about to be recorded: a [`Recording`] that has every field but no samples yet.
    fn begin(&mut self, recording: &Recording);

    /// Takes one sample and says whether to go on.
    fn sample(&mut self, sample: &RawSample<'_>) -> Flow;

    /// Receives a sample that is no part of the experiment: the arm is on its way to the start pose, or stands there, or at
    /// the end of its motion. A guard checks it, nothing records it. Its index means nothing, and its time counts on to
    /// the first sample of the experiment and on from the last, from zero along a way to the start pose. The
    /// default calls [`Sink::idle`] with an age of zero.
    fn unrecorded(&mut self, sample: &RawSample<'_>) -> Flow {
        let _ = sample;
        self.idle(0.0)
    }

    /// Receives each joint state of an arm in real time as it arrives, before the samples that follow from it, and returns
    /// whether to go on. Nothing records it; a guard judges it by the local clock as well.
    fn received(&mut self, state: &ReceivedState<'_>) -> Flow {
        let _ = state;
        Flow::Continue
    }

    /// Is called where no sample has come for `age_s` by the local monotonic clock, and returns whether to go on. An arm in
    /// real time calls it at least every 5 ms while it waits; a simulated one, which never waits, does not.
    fn idle(&mut self, age_s: f64) -> Flow {
        let _ = age_s;
        Flow::Continue
    }

    /// Receives a set-point (rad, m; n values) before it is sent, and returns whether to send it. An arm that streams asks
    /// for each one; one that hands its motion over whole does not. `age_s` is the time since the set-point was due.
    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        let _ = (set_point, age_s);
        Flow::Continue
    }
}

/// Whether an experiment goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Come to rest and end.
    Stop,
    /// Take this action at once, command nothing else, and end.
    Trip(SafeAction),
}

impl Flow {
    /// Whether the experiment ends here.
    pub const fn ends(self) -> bool {
        !matches!(self, Self::Continue)
    }
}

/// How an experiment ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// Everything was performed.
    Completed,
    /// The sink asked to stop.
    Stopped {
        /// Time of the last sample, s.
        t: f64,
        /// Phase of the last sample.
        phase: Phase,
        /// Whether the arm is known to stand.
        rest: Rest,
    },
    /// The motion diverged.
    Diverged {
        /// When, s.
        t: f64,
        /// In which phase.
        phase: Phase,
        /// What went wrong.
        reason: DivergenceError,
    },
    /// A guard, ours or the robot's own, tripped and asked for its safe action.
    Tripped {
        /// Time of the last sample, s.
        t: f64,
        /// Phase of the last sample.
        phase: Phase,
        /// Which, why, and what was done.
        trip: Box<TripReport>,
    },
}

impl Ending {
    /// Whether everything was performed.
    pub const fn is_complete(&self) -> bool {
        matches!(self, Self::Completed)
    }

    /// Whether an arm that was asked to stop was seen at rest; `None` where none was asked.
    pub const fn rest(&self) -> Option<&Rest> {
        match self {
            Self::Stopped { rest, .. } => Some(rest),
            Self::Tripped { trip, .. } => Some(&trip.rest),
            Self::Completed | Self::Diverged { .. } => None,
        }
    }

    /// Whether the arm was asked to stop and was not seen at rest.
    pub fn is_unconfirmed(&self) -> bool {
        self.rest().is_some_and(|rest| rest.is_unconfirmed())
    }
}

/// How a motion diverged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum DivergenceError {
    /// The plant failed.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A joint is faster than ten times its limit.
    #[error("joint \"{joint}\": speed {found:.3} exceeds ten times its limit {limit:.3} (rad/s or m/s)")]
    Speed { joint: String, found: f64, limit: f64 },
}

/// Why an experiment cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ArmError {
    /// The plan cannot be performed.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The servo cannot sample at the rate that the plan asks for.
    #[error("the servo runs at {servo_hz} Hz, expected a whole multiple of the plan's {rate_hz} Hz")]
    Rate { servo_hz: f64, rate_hz: f64 },
    /// A stored recording is of another experiment.
    #[error(transparent)]
    Mismatch(#[from] PlanMismatchError),
    /// A check before the first motion did not pass.
    #[error("preflight, {check}: found {found}, expected {expected}")]
    Refused { check: &'static str, found: String, expected: Expectation },
    /// The arm itself cannot begin: no link, not homed, not enabled.
    #[error("{arm}: {reason}")]
    Unavailable { arm: String, reason: String },
}
