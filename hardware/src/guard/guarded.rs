//! The guard around an arm.

use armid::experiment::{
    Arm, ArmError, Ending, ExperimentPlan, Flow, Phase, RawSample, ReceivedState, Recording, Sink, TripReport,
};
use armid::model::Robot;

use super::state::TELL_EVERY_S;
use super::{Activity, GuardRecord, GuardSettings, GuardState, JointBounds, Mode, Observer, Watch, preflight};

/// An arm that is watched: it performs what the arm inside performs, and ends where a check trips.
///
/// ```text
/// plan → preflight → [approach] → arm inside ── sample, silence, set-point ──→ Watch ──→ sink
///                                     ↑                                          │
///                                     └────────── Flow::Trip(safe action) ───────┘
/// ```
/// One watch judges all of it: the approach, the arm that stands at its start pose, the experiment, and the arm that
/// stands at its end. After a trip every further sample, silence and set-point is answered with the same safe action, and
/// no further experiment begins.
pub struct Guarded<A> {
    arm: A,
    robot: Robot,
    settings: GuardSettings,
    mode: Mode,
    bounds: Vec<JointBounds>,
    disables: bool,
    record: GuardRecord,
    observer: Option<Observer>,
}

impl<A: Arm> Guarded<A> {
    /// A guard around an arm of this robot.
    pub fn new(arm: A, robot: &Robot, settings: &GuardSettings, mode: Mode) -> Self {
        let record = GuardRecord::new(settings, mode);
        let bounds = JointBounds::of_robot(robot, settings);
        let (robot, settings) = (robot.clone(), settings.clone());
        Self { arm, robot, settings, mode, bounds, disables: true, record, observer: None }
    }

    /// Returns this guard, which ends the motion instead where nothing `disables` the drives.
    #[must_use]
    pub fn with_disable(mut self, disables: bool) -> Self {
        self.disables = disables;
        self.record.disables = disables;
        self
    }

    /// Returns this guard, which reports its state to an observer.
    #[must_use]
    pub fn with_observer(mut self, observer: Observer) -> Self {
        self.observer = Some(observer);
        self
    }

    /// What the guard did and saw so far.
    pub fn record(&self) -> &GuardRecord {
        &self.record
    }

    /// The arm inside, to read from.
    pub fn arm(&self) -> &A {
        &self.arm
    }
}

impl<A: Arm> Arm for Guarded<A> {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        if let Some(trip) = &self.record.trip {
            let reason = format!("it has tripped ({trip}); look at the arm, then begin anew");
            return Err(ArmError::Unavailable { arm: "guard".to_owned(), reason });
        }
        self.record.rate_hz = plan.rate_hz;
        self.record.preflight = preflight::of_plan(&self.robot, &self.settings, &self.bounds, plan)?;
        let mut watched = Watched {
            watch: Watch::new(&self.robot, &self.bounds, &self.settings, self.mode, plan.rate_hz)
                .with_disable(self.disables),
            sink,
            mode: self.mode,
            period_s: 1.0 / plan.rate_hz,
            doing: Activity::Approach,
            observer: self.observer.as_mut(),
            told_s: f64::NEG_INFINITY,
            last: (0.0, Phase::Settle),
            ahead_s: None,
        };
        let ending = self.arm.perform(plan, &mut watched);
        watched.report(Activity::Ended);
        let Watched { watch, last: (t, phase), .. } = watched;
        let ending = ending?;
        self.record.used = watch.used().into_iter().map(|(trip, used)| (trip.name(), used)).collect();
        let ending = match (watch.tripped(), ending) {
            // The trip states what was asked for, the arm inside what came of it.
            (Some(trip), Ending::Stopped { rest, .. }) => {
                Ending::Tripped { t, phase, trip: Box::new(TripReport { rest, ..trip.clone() }) }
            }
            (Some(trip), Ending::Tripped { trip: inside, .. }) => {
                let rest = inside.rest.clone();
                Ending::Tripped { t, phase, trip: Box::new(TripReport { rest, ..trip.clone() }) }
            }
            (Some(trip), Ending::Completed | Ending::Diverged { .. }) => {
                Ending::Tripped { t, phase, trip: Box::new(trip.clone()) }
            }
            (None, ending) => ending,
        };
        if let Ending::Tripped { trip, .. } = &ending {
            self.record.trip = Some(TripReport::clone(trip));
        }
        Ok(ending)
    }
}

/// Between an arm and its sink.
struct Watched<'a> {
    watch: Watch,
    sink: &'a mut dyn Sink,
    mode: Mode,
    period_s: f64,
    doing: Activity,
    observer: Option<&'a mut Observer>,
    /// When the observer last received the state, in the watch's time, s.
    told_s: f64,
    /// Time and phase of the last sample.
    last: (f64, Phase),
    /// How far the watch's time is ahead of the samples', s; none before the first sample.
    ahead_s: Option<f64>,
}

impl Watched<'_> {
    /// Judges a sample. Every motion counts its time from its own zero, the watch goes on: where time goes back, one
    /// period has passed.
    fn judge(&mut self, sample: &RawSample<'_>) {
        let ahead_s = match self.ahead_s {
            None => 0.0,
            Some(ahead_s) if sample.t < self.last.0 => ahead_s + self.last.0 + self.period_s - sample.t,
            Some(ahead_s) => ahead_s,
        };
        self.ahead_s = Some(ahead_s);
        self.last = (sample.t, sample.phase);
        self.watch.sample(&RawSample { t: sample.t + ahead_s, ..*sample });
    }

    /// Gives the state to the observer, where there is one.
    fn report(&mut self, doing: Activity) {
        if let Some(observer) = &mut self.observer {
            observer(&GuardState::new(self.mode, doing, self.last, &self.watch));
        }
    }

    /// Gives the state to the observer where it is time to; never before a safe action.
    fn tell_now_and_then(&mut self) {
        let now_s = self.last.0 + self.ahead_s.unwrap_or_default();
        if self.observer.is_some() && self.watch.tripped().is_none() && now_s >= self.told_s + TELL_EVERY_S {
            self.told_s = now_s;
            self.report(self.doing);
        }
    }

    /// A trip takes precedence over the answer of the sink.
    fn answer(&self, sink: Flow) -> Flow {
        self.watch.tripped().map_or(sink, |trip| Flow::Trip(trip.action))
    }
}

impl Sink for Watched<'_> {
    fn begin(&mut self, recording: &Recording) {
        if self.watch.tripped().is_none() {
            // The approach may have begun outside the soft limits: what counts is how close the experiment came.
            self.watch.reset_used();
            self.doing = Activity::Experiment;
        }
        self.sink.begin(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        if self.watch.tripped().is_some() {
            return self.answer(Flow::Stop);
        }
        self.judge(sample);
        // The sample that trips is recorded too: it is the evidence.
        let flow = self.sink.sample(sample);
        self.tell_now_and_then();
        self.answer(flow)
    }

    fn unrecorded(&mut self, sample: &RawSample<'_>) -> Flow {
        if self.watch.tripped().is_some() {
            return self.answer(Flow::Stop);
        }
        self.judge(sample);
        self.tell_now_and_then();
        let flow = self.sink.unrecorded(sample);
        self.answer(flow)
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Flow {
        self.watch.received(state);
        let flow = self.sink.received(state);
        self.answer(flow)
    }

    fn idle(&mut self, age_s: f64) -> Flow {
        self.watch.idle(age_s);
        let flow = self.sink.idle(age_s);
        self.answer(flow)
    }

    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        self.watch.command(set_point, age_s);
        let flow = self.sink.command(set_point, age_s);
        self.answer(flow)
    }
}
