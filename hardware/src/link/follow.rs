//! Following one motion from beginning to end: handing it over or streaming it, and watching the arm meanwhile.

use std::time::{Duration, Instant};

use armid::experiment::{Flow, SafeAction};

use super::sender::Progress;
use super::stamps::Stamp;
use super::{GridSample, JointRow, LinkError, Motion, Resampler, Ros2Arm, StampWatch, points};
use crate::message::{Header, JointTrajectory, Time};

/// Who hears what the arm does.
pub(crate) trait Listener {
    /// Takes one sample, with what was commanded at its time.
    fn sample(&mut self, sample: &GridSample, command: &[f64]) -> Flow;

    /// Hears a joint state `t` seconds after the beginning of the motion where the grid has no tick for it: the arm
    /// stands where the motion will begin, or has ended.
    fn standing(&mut self, t: f64, row: &JointRow, command: &[f64]) -> Flow;

    /// Hears that no joint state has come for `age_s`.
    fn idle(&mut self, age_s: f64) -> Flow;

    /// Hears a set-point before it is streamed, `age_s` after it was due.
    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow;
}

/// How following a motion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Followed {
    /// The motion was performed to its end.
    Whole,
    /// The listener said stop, and the arm was brought to rest.
    Stopped,
    /// The listener asked for this action, and it was taken at once.
    Acted(SafeAction),
}

/// How long to wait for the next message before the listener hears of silence.
const PATIENCE: Duration = Duration::from_millis(2);
/// How long the arm may take to come to rest after a stop, and the robot's computer to say that a motion has ended.
const TO_REST: Duration = Duration::from_secs(3);

/// How often a safe action is said again, and how soon.
const INSIST: usize = 10;
const INSIST_EVERY: Duration = Duration::from_millis(20);

/// Whether a robot's computer that says `state` can move the arm: `disabled`, `estop` and `fault` say that it cannot.
pub(crate) fn is_enabled(state: &str) -> bool {
    !["disabled", "estop", "fault"].iter().any(|word| state.starts_with(word))
}

/// One motion under way.
struct Run<'a> {
    motion: &'a dyn Motion,
    start_ns: i64,
    rate_hz: f64,
    /// Where on the motion a streamed stop began, and how long it takes, s.
    brake: Option<(f64, f64)>,
    state: [Vec<f64>; 3],
}

impl Run<'_> {
    /// Commanded position at `t` seconds after the beginning; while braking, time on the motion slows down evenly.
    fn command(&mut self, t: f64) -> &[f64] {
        let t = match self.brake {
            Some((from, span)) if t > from => {
                let u = (t - from).min(span);
                from + u - 0.5 * u * u / span
            }
            _ => t,
        };
        let [q, qd, qdd] = &mut self.state;
        self.motion.at(t.clamp(0.0, self.motion.duration_s()), q, qd, qdd);
        q
    }

    fn since_start(&self, stamp_ns: i64) -> f64 {
        (stamp_ns - self.start_ns) as f64 * 1e-9
    }
}

impl Ros2Arm {
    /// Performs a motion that begins where the arm stands, sampled at `rate_hz`.
    ///
    /// # Errors
    /// [`LinkError`] where the robot's computer refuses, the link breaks or messages make no sense; the motion is
    /// cancelled then.
    pub(crate) fn follow(
        &mut self,
        motion: &dyn Motion,
        rate_hz: f64,
        listener: &mut dyn Listener,
    ) -> Result<Followed, LinkError> {
        let followed = self.run(motion, rate_hz, listener);
        match &followed {
            Ok(Followed::Whole | Followed::Stopped) => {}
            Ok(Followed::Acted(action)) => self.insist(*action),
            // Whatever went wrong, the arm must not go on.
            Err(_) => self.insist(SafeAction::Cancel),
        }
        followed
    }

    /// Says a safe action again and again for a while: whoever ends at once takes the message that is on its way along.
    fn insist(&mut self, action: SafeAction) {
        for _ in 0..INSIST {
            // An error adds nothing: there is no better action than this one.
            let _ = self.act(action);
            std::thread::sleep(INSIST_EVERY);
        }
    }

    fn run(&mut self, motion: &dyn Motion, rate_hz: f64, listener: &mut dyn Listener) -> Result<Followed, LinkError> {
        let (newest, mut alive) = self.newest()?;
        let mut watch = StampWatch::new(1.0 / self.rate_hz);
        let origin = Instant::now();
        // The motion begins a whole number of messages ahead, so that stamps without jitter lie on the grid.
        let lead = (self.settings.lead_s * self.rate_hz).ceil() / self.rate_hz;
        let start_ns = newest.stamp_ns + (lead * 1e9).round() as i64;
        let samples = (motion.duration_s() * rate_hz - 1e-6).ceil() as usize;
        let mut grid = Resampler::new(start_ns, rate_hz, samples);
        let zero = vec![0.0; motion.dof()];
        let mut run = Run { motion, start_ns, rate_hz, brake: None, state: [zero.clone(), zero.clone(), zero] };
        self.hand_over(&run)?;
        let mut settled = Vec::new();
        let mut ended = !self.sender.tells_the_end();
        let mut resting: Option<Instant> = None;
        loop {
            self.hear_state();
            if let Some(state) = self.state.as_ref().filter(|state| !is_enabled(state)) {
                return Err(LinkError::Aborted { reason: format!("it says \"{state}\"") });
            }
            let told = self.sender.poll();
            if resting.is_none() {
                ended |= told? == Progress::Done;
            } else if matches!(told, Ok(Progress::Done | Progress::Cancelled) | Err(_)) {
                ended = true;
            }
            if let Some(since) = resting {
                let rest = run.brake.map_or(TO_REST, |(_, span)| Duration::from_secs_f64(span + 0.1));
                let told = self.sender.tells_the_end() && ended;
                if told || since.elapsed() > rest.min(TO_REST) {
                    self.findings = watch.findings().clone();
                    return Ok(Followed::Stopped);
                }
            } else if grid.is_done() && (ended || alive.elapsed() > TO_REST) {
                self.findings = watch.findings().clone();
                return Ok(Followed::Whole);
            }
            let Some(heard) = self.inbox.next(PATIENCE) else {
                let age_s = alive.elapsed().as_secs_f64();
                if age_s > self.settings.patience_s {
                    let what = self.settings.full(&self.settings.joint_states);
                    return Err(LinkError::Silence { what, waited_s: age_s, domain: self.settings.domain });
                }
                if resting.is_none()
                    && let Some(end) = self.obey(listener.idle(age_s), &mut run, &mut resting)?
                {
                    self.findings = watch.findings().clone();
                    return Ok(end);
                }
                continue;
            };
            let message =
                heard.message.map_err(|reason| LinkError::Middleware { what: "joint state".to_owned(), reason })?;
            let row = self.map.row(&message)?;
            self.latest = Some((row.clone(), heard.at));
            let stamp = watch.see(row.stamp_ns, heard.at.duration_since(origin).as_secs_f64());
            // A message that says nothing new is as good as none, and one that was long on its way is as old as that.
            let age_s = match stamp {
                Stamp::Fresh => {
                    alive = heard.at;
                    watch.lateness_s()
                }
                Stamp::Stale => alive.elapsed().as_secs_f64().max(watch.lateness_s()),
                Stamp::Jumped(by) => {
                    self.findings = watch.findings().clone();
                    let reason = format!("its clock jumped by {by:.3} s; samples after it have no place in time");
                    return Err(LinkError::Aborted { reason });
                }
            };
            if (stamp == Stamp::Stale || age_s * self.rate_hz > 1.0)
                && resting.is_none()
                && let Some(end) = self.obey(listener.idle(age_s), &mut run, &mut resting)?
            {
                self.findings = watch.findings().clone();
                return Ok(end);
            }
            if stamp == Stamp::Stale {
                continue;
            }
            if self.sender.streams()
                && let Some(end) = self.stream(&mut run, row.stamp_ns, heard.at, listener, &mut resting)?
            {
                self.findings = watch.findings().clone();
                return Ok(end);
            }
            if resting.is_none() && (row.stamp_ns < start_ns || grid.is_done()) {
                let t = run.since_start(row.stamp_ns);
                let flow = listener.standing(t, &row, run.command(t));
                if let Some(end) = self.obey(flow, &mut run, &mut resting)? {
                    self.findings = watch.findings().clone();
                    return Ok(end);
                }
            }
            settled.clear();
            grid.push(row, &mut settled);
            for sample in &settled {
                if resting.is_some() {
                    break;
                }
                if !sample.measured {
                    watch.miss(sample.index);
                }
                let flow = listener.sample(sample, run.command(sample.index as f64 / run.rate_hz));
                if let Some(end) = self.obey(flow, &mut run, &mut resting)? {
                    self.findings = watch.findings().clone();
                    return Ok(end);
                }
            }
        }
    }

    /// Hands the motion over whole, with the time of the robot's clock at which it begins.
    fn hand_over(&mut self, run: &Run<'_>) -> Result<(), LinkError> {
        if self.sender.streams() {
            return Ok(());
        }
        let trajectory = JointTrajectory {
            header: Header { stamp: Time::from_ns(run.start_ns), frame_id: String::new() },
            joint_names: self.map.names().to_vec(),
            points: points(run.motion, self.settings.point_spacing_s),
        };
        self.sender.hand_over(trajectory)
    }

    /// Streams the set-point that is due one message after the one with the stamp `stamp_ns`.
    fn stream(
        &mut self,
        run: &mut Run<'_>,
        stamp_ns: i64,
        due: Instant,
        listener: &mut dyn Listener,
        resting: &mut Option<Instant>,
    ) -> Result<Option<Followed>, LinkError> {
        let t = run.since_start(stamp_ns) + 1.0 / self.rate_hz;
        let set_point = run.command(t).to_vec();
        if resting.is_none() {
            let flow = listener.command(&set_point, due.elapsed().as_secs_f64());
            if let Some(end) = self.obey(flow, run, resting)? {
                return Ok(Some(end));
            }
        }
        self.sender.set_point(&set_point).map(|()| None)
    }

    /// Does what a listener says.
    fn obey(
        &mut self,
        flow: Flow,
        run: &mut Run<'_>,
        resting: &mut Option<Instant>,
    ) -> Result<Option<Followed>, LinkError> {
        match flow {
            Flow::Continue => Ok(None),
            Flow::Trip(action) => self.act(action).map(|()| Some(Followed::Acted(action))),
            Flow::Stop => {
                *resting = Some(Instant::now());
                self.sender.cancel()?;
                if self.sender.streams() {
                    run.brake = self.latest.as_ref().map(|(row, _)| {
                        let t = run.since_start(row.stamp_ns).clamp(0.0, run.motion.duration_s());
                        run.command(t);
                        (t, stopping_time(&self.robot, &run.state[1]))
                    });
                }
                Ok(None)
            }
        }
    }
}

/// Time in which every joint stops at half its acceleration limit, at least 0.1 s.
fn stopping_time(robot: &armid::model::Robot, qd: &[f64]) -> f64 {
    let longest = robot.joints().iter().zip(qd).map(|(joint, qd)| 2.0 * qd.abs() / joint.limits.acceleration);
    longest.fold(0.1, f64::max).min(2.0)
}
