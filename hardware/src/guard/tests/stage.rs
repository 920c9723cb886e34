//! An arm on a virtual clock that does what a test asks, and records what it is asked.

use armid::experiment::{
    Arm, ArmError, Command, Ending, ExperimentPlan, Flow, Phase, RawSample, Recording, Rest, SafeAction, Sink,
    TripReport,
};
use armid::model::{EffortInterface, Robot, bundled, format::parse_robot};
use armid::trajectory::{FourierJoint, FourierTrajectory};

use crate::guard::{Approach, GuardSettings, Machine, Mode, Survey, Trip};

pub(super) fn robot() -> Robot {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("a bundled robot");
    parse_robot(entry.robot).unwrap()
}

/// The motion of [`plan`].
pub(super) fn series(part: f64) -> FourierTrajectory {
    let joint = |(i, joint): (usize, &armid::model::Joint)| {
        // ω = 2π/3 s; every second joint a quarter of a period later, so that never all of them turn back at once.
        let (now, later) = if i % 2 == 0 { (0.6, 0.0) } else { (0.0, 0.6) };
        let speed = part * joint.limits.velocity;
        let (a, b) = (vec![now * speed, 0.0], vec![later * speed, 0.15 * speed]);
        FourierJoint { name: joint.name.clone(), a, b, q0: 0.1 * i as f64 }
    };
    FourierTrajectory { period_s: 3.0, joints: robot().joints().iter().enumerate().map(joint).collect() }
}

/// A short experiment with `part` of what the A460 may do: at most 0.9 of any limit at 1.
pub(super) fn plan(part: f64, rate_hz: f64) -> ExperimentPlan {
    around(series(part), rate_hz)
}

/// A plan around another motion.
pub(super) fn around(series: FourierTrajectory, rate_hz: f64) -> ExperimentPlan {
    let usual = ExperimentPlan::new(series);
    ExperimentPlan { rate_hz, settle_s: 0.2, ramp_s: 1.0, discarded_periods: 0, periods: 1, ..usual }
}

/// The fault, from a moment on. Sizes are beyond what the joint may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fault {
    /// Nothing.
    None,
    /// A position is no number.
    NotFinite,
    /// A position is off by this much, rad.
    Jump(f64),
    /// The motion drifts outwards at this speed, rad/s, and the command with it.
    Outwards(f64),
    /// The position drifts off the command at this speed, rad/s.
    Drift(f64),
    /// A current stays at this part of its limit.
    Current(f64),
    /// The arm stands, all joints.
    Stop,
    /// No state comes any more.
    Silence,
    /// Set-points are this late, s.
    Late(f64),
    /// A set-point is off by this much, rad.
    Step(f64),
    /// The robot controller aborts.
    Robot,
}

/// Everything that the arm did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Deed {
    /// A set-point was sent.
    SetPoint,
    /// The safe action was taken.
    Safe(SafeAction),
    /// It came to rest because the sink wanted to.
    Rest,
}

/// An arm on a virtual clock.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub(super) robot: Robot,
    pub(super) mode: Mode,
    pub(super) fault: Fault,
    pub(super) joint: usize,
    /// When the fault begins, s by the stage's clock: zero where its first motion begins.
    pub(super) at_s: f64,
    /// How long it stands at the start pose before an experiment begins, s.
    pub(super) lead_s: f64,
    /// Whether it refuses to perform once it is at the start pose.
    pub(super) gives_up: bool,
    /// Lag of the arm behind its command, s.
    pub(super) lag_s: f64,
    /// Deterministic noise: size of stamps' jitter in sampling periods, and of positions, rad.
    pub(super) jitter: f64,
    pub(super) noise: f64,
    /// By the stage's clock, when the next motion's first state comes.
    pub(super) clock_s: Option<f64>,
    /// What happened, with its time.
    pub(super) deeds: Vec<(f64, Deed)>,
    /// When the fault first exceeded the limit of its check, as the stage itself sees it.
    pub(super) crossed_s: Option<f64>,
    /// Where it stands before its first motion.
    pub(super) stands: Vec<f64>,
    pub(super) settings: GuardSettings,
}

impl Stage {
    pub(super) fn new(mode: Mode, settings: &GuardSettings) -> Self {
        let robot = robot();
        Self {
            stands: vec![0.0; robot.dof()],
            robot,
            mode,
            fault: Fault::None,
            joint: 0,
            at_s: 0.0,
            lead_s: 0.0,
            gives_up: false,
            clock_s: None,
            lag_s: 0.005,
            jitter: 0.0,
            noise: 0.0,
            deeds: Vec::new(),
            crossed_s: None,
            settings: settings.clone(),
        }
    }

    /// A number between −1 and 1 that looks random: the fractional part of a fast chirp.
    fn dither(k: usize, salt: usize) -> f64 {
        let x = ((k * 7919 + salt * 104_729) % 65_537) as f64 / 65_537.0;
        2.0 * x - 1.0
    }

    fn crossed(&mut self, t: f64) {
        self.crossed_s.get_or_insert(t);
    }

    /// After the end the last messages are still on their way: anything the sink receives, its answer must stay.
    fn aftermath(&mut self, t: f64, first: Flow, sample: &RawSample<'_>, sink: &mut dyn Sink) {
        let deed = match first {
            Flow::Trip(action) => Deed::Safe(action),
            _ => Deed::Rest,
        };
        self.deeds.push((t, deed));
        if deed == Deed::Rest {
            return;
        }
        for k in 0..100 {
            let healthy = RawSample { index: sample.index + k, t: t + k as f64 * 1e-3, ..*sample };
            let flows = [sink.sample(&healthy), sink.unrecorded(&healthy)];
            let answers = [flows[0], flows[1], sink.idle(1e-3), sink.command(healthy.command, 0.0)];
            assert_eq!(answers, [first; 4], "a guard that has tripped stays tripped");
        }
    }

    /// Performs a motion from time zero, after `lead` samples at rest. Samples with a phase are recorded. `None` where it
    /// went through.
    fn follow(
        &mut self,
        motion: &dyn Fn(f64, &mut [f64]),
        phases: &dyn Fn(usize) -> Option<Phase>,
        (lead, samples): (usize, usize),
        rate_hz: f64,
        sink: &mut dyn Sink,
    ) -> Option<Ending> {
        let n = self.robot.dof();
        let joint = self.joint;
        let (mut q, mut command, mut before) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let lead_s = lead as f64 / rate_hz;
        let ahead_s = self.clock_s.map_or(0.0, |clock_s| clock_s + lead_s);
        self.clock_s = Some(ahead_s + samples as f64 / rate_hz);
        let (mut frozen, mut last_t) = (None, ahead_s - lead_s);
        let bounds = crate::guard::JointBounds::of_robot(&self.robot, &self.settings);
        for k in 0..lead + samples {
            let t = (k as f64 + self.jitter * 0.4 * Self::dither(k, 0)).max(0.0) / rate_hz - lead_s;
            // What went wrong goes on, any motion being under way.
            let now = t + ahead_s;
            let faulty = self.fault != Fault::None && now >= self.at_s;
            let since = now - self.at_s;
            motion(t.max(0.0), &mut command);
            motion((t - self.lag_s).max(0.0), &mut q);
            for (j, q) in q.iter_mut().enumerate() {
                *q += self.noise * Self::dither(k, j + 1);
            }
            let mut effort: Vec<f64> = (0..n).map(|j| 0.5 * Self::dither(k, 10 + j)).collect();
            let recorded = k.checked_sub(lead).and_then(phases);
            let phase = recorded.unwrap_or(Phase::Settle);
            let mut late = 0.0;
            if faulty {
                match self.fault {
                    Fault::None => {}
                    Fault::NotFinite => q[joint] = f64::NAN,
                    Fault::Jump(size) => q[joint] += size,
                    Fault::Outwards(speed) => {
                        q[joint] += speed * since;
                        command[joint] += speed * since;
                    }
                    Fault::Drift(speed) => q[joint] += speed * since,
                    Fault::Current(part) => effort[joint] = part * self.robot.joints()[joint].drive.current_limit,
                    Fault::Stop => q.clone_from(frozen.get_or_insert(q.clone())),
                    Fault::Late(age) => late = age,
                    Fault::Step(size) => command[joint] += size,
                    Fault::Robot => {
                        self.crossed(now);
                        let reason = "the robot controller reports estop".to_owned();
                        let settings = &self.settings;
                        let trip =
                            crate::guard::watch::report(Trip::RobotStopped, reason, settings, self.mode, rate_hz);
                        self.deeds.push((now, Deed::Safe(trip.action)));
                        return Some(Ending::Tripped { t, phase, trip: Box::new(trip) });
                    }
                    Fault::Silence => {
                        // The last state came at `last_t`; the arm looks at its guard every 5 ms.
                        self.crossed(last_t);
                        for tick in 1..1000 {
                            let age = f64::from(tick) * 5e-3;
                            let flow = sink.idle(age);
                            if flow.ends() {
                                let sample = RawSample {
                                    index: k,
                                    t,
                                    phase,
                                    q: &before,
                                    effort: &effort,
                                    voltage: &[],
                                    link_q: &[],
                                    command: &command,
                                };
                                self.aftermath(last_t + age, flow, &sample, sink);
                                return Some(Ending::Stopped {
                                    t: last_t,
                                    phase,
                                    rest: Rest::Confirmed { after_ms: 0.0 },
                                });
                            }
                        }
                        return None;
                    }
                }
                let line = &bounds[joint];
                let crossed = match self.fault {
                    Fault::Outwards(_) => q[joint] > line.soft.1 || q[joint] < line.soft.0,
                    Fault::Drift(_) => (q[joint] - command[joint]).abs() > line.following,
                    Fault::Step(size) => size.abs() > 0.0 && self.mode == Mode::Stream,
                    Fault::Late(_) => self.mode == Mode::Stream,
                    _ => true,
                };
                if crossed {
                    let gradual = matches!(self.fault, Fault::Outwards(_) | Fault::Drift(_));
                    self.crossed(if gradual { now } else { self.at_s });
                }
            }
            let index = k.saturating_sub(lead);
            let sample =
                RawSample { index, t, phase, q: &q, effort: &effort, voltage: &[], link_q: &[], command: &command };
            let flow = if recorded.is_some() { sink.sample(&sample) } else { sink.unrecorded(&sample) };
            if flow.ends() {
                self.aftermath(now, flow, &sample, sink);
                return Some(Ending::Stopped { t, phase, rest: Rest::Confirmed { after_ms: 0.0 } });
            }
            if self.mode == Mode::Stream {
                let flow = sink.command(&command, late);
                if flow.ends() {
                    self.aftermath(now + late, flow, &sample, sink);
                    return Some(Ending::Stopped { t, phase, rest: Rest::Confirmed { after_ms: 0.0 } });
                }
                self.deeds.push((now, Deed::SetPoint));
            }
            before.copy_from_slice(&q);
            last_t = now;
        }
        None
    }
}

impl Arm for Stage {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        if self.gives_up {
            let reason = "the robot controller reports \"estop\"".to_owned();
            return Err(ArmError::Unavailable { arm: "stage".to_owned(), reason });
        }
        sink.begin(&self.announcement(plan)?);
        let command = Command::new(plan, &layout);
        let n = self.robot.dof();
        let motion = |t: f64, q: &mut [f64]| command.evaluate(t, q, &mut vec![0.0; n], &mut vec![0.0; n]);
        let samples = ((self.lead_s * plan.rate_hz).round() as usize, layout.samples());
        let ended = self.follow(&motion, &|k| Some(layout.phase(k)), samples, plan.rate_hz, sink);
        Ok(ended.unwrap_or(Ending::Completed))
    }
}

impl Machine for Stage {
    fn survey(&mut self) -> Result<Survey, ArmError> {
        let joints = self.robot.joints().iter().map(|joint| joint.name.clone()).collect();
        Ok(Survey { joints, q: self.stands.clone(), rate_hz: 1000.0, homed: Some(true), ..Survey::default() })
    }

    fn announcement(&self, plan: &ExperimentPlan) -> Result<Recording, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        Ok(Recording {
            effort_unit: EffortInterface::Current,
            ..Recording::empty(&self.robot, "", plan, &layout, None)
        })
    }

    fn approach(&mut self, approach: &Approach, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let n = self.robot.dof();
        let motion = |t: f64, q: &mut [f64]| approach.evaluate(t, q, &mut vec![0.0; n], &mut vec![0.0; n]);
        let samples = (approach.duration_s * 1000.0).ceil() as usize;
        let ended = self.follow(&motion, &|_| None, (0, samples), 1000.0, sink);
        Ok(ended.unwrap_or(Ending::Completed))
    }
}

/// A sink that counts, and that may want to stop.
#[derive(Debug, Default)]
pub(super) struct Count {
    pub(super) begun: usize,
    pub(super) samples: usize,
    pub(super) stop_at: Option<usize>,
}

impl Sink for Count {
    fn begin(&mut self, _: &Recording) {
        self.begun += 1;
    }

    fn sample(&mut self, _: &RawSample<'_>) -> Flow {
        self.samples += 1;
        if self.stop_at.is_some_and(|at| self.samples >= at) { Flow::Stop } else { Flow::Continue }
    }
}

pub(super) fn tripped(ending: &Ending) -> &TripReport {
    match ending {
        Ending::Tripped { trip, .. } => trip,
        other => panic!("{other:?}, expected a trip"),
    }
}
