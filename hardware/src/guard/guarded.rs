//! The guard around an arm.

use armid::experiment::{Arm, ArmError, Ending, ExperimentPlan, Flow, Phase, RawSample, Recording, Sink, TripReport};
use armid::model::Robot;

use super::state::TELL_EVERY_S;
use super::{Doing, GuardRecord, GuardSettings, GuardState, JointBounds, Mode, Observer, Watch, preflight};

/// An arm that is watched: it performs what the arm inside performs, and ends where a check trips.
///
/// ```text
/// plan → preflight → [approach] → arm inside ── sample, silence, set-point ──→ Watch ──→ sink
///                                     ↑                                          │
///                                     └────────── Flow::Trip(safe action) ───────┘
/// ```
/// Samples before [`Sink::begin`] belong to the approach: they are judged and not recorded. After a trip every further
/// sample, silence and set-point is answered with the same safe action, and no further experiment begins.
pub struct Guarded<A> {
    arm: A,
    robot: Robot,
    settings: GuardSettings,
    mode: Mode,
    bounds: Vec<JointBounds>,
    record: GuardRecord,
    observer: Option<Observer>,
}

impl<A: Arm> Guarded<A> {
    /// A guard around an arm of this robot.
    pub fn new(arm: A, robot: &Robot, settings: &GuardSettings, mode: Mode) -> Self {
        let record = GuardRecord::new(settings, mode);
        let bounds = JointBounds::of_robot(robot, settings);
        Self { arm, robot: robot.clone(), settings: settings.clone(), mode, bounds, record, observer: None }
    }

    /// The same guard, which tells its state to an observer.
    #[must_use]
    pub fn with_observer(mut self, observer: Observer) -> Self {
        self.observer = Some(observer);
        self
    }

    /// What the guard did and saw so far.
    #[must_use]
    pub fn record(&self) -> &GuardRecord {
        &self.record
    }

    /// The arm inside, to read from.
    #[must_use]
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
            watch: Watch::new(&self.bounds, &self.settings, self.mode, plan.rate_hz),
            spare: Some(Watch::new(&self.bounds, &self.settings, self.mode, plan.rate_hz)),
            sink,
            mode: self.mode,
            observer: self.observer.as_mut(),
            told_s: f64::NEG_INFINITY,
            last: (0.0, Phase::Settle),
        };
        let ending = self.arm.perform(plan, &mut watched);
        watched.tell(Doing::Ended);
        let Watched { watch, last: (t, phase), .. } = watched;
        let ending = ending?;
        self.record.used = watch.used().into_iter().map(|(trip, used)| (trip.name(), used)).collect();
        let ending = match watch.tripped() {
            Some(trip) => Ending::Tripped { t, phase, trip: Box::new(trip.clone()) },
            None => ending,
        };
        if let Ending::Tripped { trip, .. } = &ending {
            self.record.trip = Some(TripReport::clone(trip));
        }
        Ok(ending)
    }
}

/// Stands between an arm and its sink.
struct Watched<'a> {
    watch: Watch,
    /// Takes over from the approach's when the experiment begins.
    spare: Option<Watch>,
    sink: &'a mut dyn Sink,
    mode: Mode,
    observer: Option<&'a mut Observer>,
    /// When the observer was told last, in the samples' time, s.
    told_s: f64,
    last: (f64, Phase),
}

impl Watched<'_> {
    fn begun(&self) -> bool {
        self.spare.is_none()
    }

    /// Tells the observer, where there is one.
    fn tell(&mut self, doing: Doing) {
        if let Some(observer) = &mut self.observer {
            observer(&GuardState::new(self.mode, doing, self.last, &self.watch));
        }
    }

    /// Tells the observer where it is time to; never before a safe action.
    fn tell_now_and_then(&mut self, doing: Doing) {
        if self.observer.is_some() && self.watch.tripped().is_none() && self.last.0 >= self.told_s + TELL_EVERY_S {
            self.told_s = self.last.0;
            self.tell(doing);
        }
    }

    /// A trip comes before what the sink wants.
    fn answer(&self, sink: Flow) -> Flow {
        self.watch.tripped().map_or(sink, |trip| Flow::Trip(trip.action))
    }
}

impl Sink for Watched<'_> {
    fn begin(&mut self, recording: &Recording) {
        if let Some(watch) = self.spare.take()
            && self.watch.tripped().is_none()
        {
            self.watch = watch;
            self.told_s = f64::NEG_INFINITY;
        }
        self.sink.begin(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        if self.watch.tripped().is_some() {
            return self.answer(Flow::Stop);
        }
        self.watch.sample(sample);
        self.last = (sample.t, sample.phase);
        if !self.begun() {
            self.tell_now_and_then(Doing::Approach);
            let flow = self.sink.idle(0.0);
            return self.answer(flow);
        }
        // The sample that trips is recorded too: it is the evidence.
        let flow = self.sink.sample(sample);
        self.tell_now_and_then(Doing::Experiment);
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
