//! Following one motion from beginning to end: handing it over or streaming it, and watching the arm meanwhile.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use armid::experiment::{Flow, ReceivedState, Rest, SafeAction};

use super::pieces::{Piece, piece};
use super::stamps::Stamp;
use super::{GridSample, JointRow, LinkError, Motion, Resampler, Ros2Arm, StampWatch, points};
use crate::message::{Header, JointTrajectory, Time};

/// Who receives what the arm does.
pub(crate) trait Listener {
    /// Takes one sample, with what was commanded at its time.
    fn sample(&mut self, sample: &GridSample, command: &[f64]) -> Flow;

    /// Takes a joint state `t` seconds after the beginning of the motion where the grid has no tick for it: the arm
    /// stands where the motion will begin, or has ended.
    fn standing(&mut self, t: f64, row: &JointRow, command: &[f64]) -> Flow;

    /// Takes a joint state as it arrives.
    fn received(&mut self, state: &ReceivedState<'_>) -> Flow;

    /// Takes that no joint state has come for `age_s`.
    fn idle(&mut self, age_s: f64) -> Flow;

    /// Takes a set-point before it is streamed, `age_s` after it was due.
    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow;
}

/// How following a motion ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Followed {
    /// The motion was performed to its end.
    Whole,
    /// The listener said stop.
    Stopped(Rest),
    /// The listener asked for this action, and it was requested at once.
    Acted(SafeAction, Rest),
    /// The robot controller gave the motion up, or the link failed; it was cancelled.
    Failed(LinkError, Rest),
}

/// Why a motion is not followed any further.
enum End {
    Whole,
    Stop,
    Act(SafeAction),
}

/// How long to wait for the next message before the listener is told that none has come.
const PATIENCE: Duration = Duration::from_millis(2);
/// How long the robot controller may take to report that a motion has ended.
pub(crate) const RESULT: Duration = Duration::from_secs(3);
/// How often to look who else is on the network, and after the middleware's threads.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Part of the way from the last piece to its braking tail after which the next piece goes out.
const RENEW: f64 = 0.3;
/// What must be left of a piece at full pace when the next one goes out, s.
const LEAST_LEFT_S: f64 = 0.05;

/// One motion under way.
pub(super) struct Run<'a> {
    motion: &'a dyn Motion,
    start_ns: i64,
    rate_hz: f64,
    /// Where on the motion a streamed stop began, and how long it takes, s.
    brake: Option<(f64, f64)>,
    state: [Vec<f64>; 3],
    /// When the last piece went out, up to where it is the motion itself, and when it rests, by the motion's time, s.
    piece: Option<(f64, f64, f64)>,
    whole_sent: bool,
}

impl<'a> Run<'a> {
    fn new(motion: &'a dyn Motion, start_ns: i64, rate_hz: f64) -> Self {
        let zero = vec![0.0; motion.dof()];
        let state = [zero.clone(), zero.clone(), zero];
        Self { motion, start_ns, rate_hz, brake: None, state, piece: None, whole_sent: false }
    }

    /// Commanded position at `t` seconds after the beginning; while braking, time on the motion slows down evenly.
    pub(super) fn command(&mut self, t: f64) -> &[f64] {
        let t = match self.brake {
            Some((from, span)) if t > from => {
                let u = (t - from).min(span);
                from + u - 0.5 * u * u / span
            }
            _ => t,
        };
        let [q, qd, qdd] = &mut self.state;
        self.motion.evaluate(t.clamp(0.0, self.motion.duration_s()), q, qd, qdd);
        q
    }

    /// Time of the motion at a stamp of the robot's clock, s.
    pub(super) fn since_start(&self, stamp_ns: i64) -> f64 {
        (stamp_ns - self.start_ns) as f64 * 1e-9
    }

    /// The robot's clock at time `t` of the motion, ns.
    pub(super) fn stamp_ns(&self, t: f64) -> i64 {
        self.start_ns + (t * 1e9).round() as i64
    }

    /// The robot's clock when the motion begins, ns.
    pub(super) fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// Whether anything was handed over.
    pub(super) const fn is_handed_over(&self) -> bool {
        self.piece.is_some()
    }

    /// Time of the motion at which everything that was handed over has come to rest by itself, s.
    pub(super) fn rest_s(&self) -> f64 {
        self.piece.map_or(0.0, |(_, _, rest_s)| rest_s)
    }
}

impl Ros2Arm {
    /// Performs a motion that begins where the arm stands, sampled at `rate_hz`. Where anything ends it early, the arm is asked
    /// to stop, and what came of it is reported.
    pub(crate) fn follow(&mut self, motion: &dyn Motion, rate_hz: f64, listener: &mut dyn Listener) -> Followed {
        // The motion begins a whole number of messages ahead, so that stamps without jitter lie on the grid.
        let lead = (self.settings.lead_s * self.rate_hz).ceil() / self.rate_hz;
        let newest = self.newest();
        self.line.sender.begin();
        let stamp_ns = self.latest.as_ref().map_or(0, |(row, _)| row.stamp_ns);
        let mut run = Run::new(motion, stamp_ns + (lead * 1e9).round() as i64, rate_hz);
        let end = newest.and_then(|_| {
            // A panic in here must not leave the arm alone with its motion.
            let watched = catch_unwind(AssertUnwindSafe(|| self.watch(&mut run, listener)));
            watched.unwrap_or_else(|panic| Err(LinkError::Panic(words(panic.as_ref()))))
        });
        match end {
            Ok(End::Whole) => Followed::Whole,
            Ok(End::Stop) => Followed::Stopped(self.halt(SafeAction::Cancel, &mut run)),
            Ok(End::Act(action)) => Followed::Acted(action, self.halt(action, &mut run)),
            Err(error) => Followed::Failed(error, self.halt(SafeAction::Cancel, &mut run)),
        }
    }

    fn watch(&mut self, run: &mut Run<'_>, listener: &mut dyn Listener) -> Result<End, LinkError> {
        let mut stamps = StampWatch::new(1.0 / self.rate_hz).with_clock(self.clock.clone());
        let end = self.watch_stamped(run, listener, &mut stamps);
        self.clock = stamps.clock().clone();
        self.findings = stamps.findings().clone();
        end
    }

    fn watch_stamped(
        &mut self,
        run: &mut Run<'_>,
        listener: &mut dyn Listener,
        watch: &mut StampWatch,
    ) -> Result<End, LinkError> {
        let (_, mut alive) = self.newest()?;
        let samples = (run.motion.duration_s() * run.rate_hz - 1e-6).ceil() as usize;
        let mut grid = Resampler::new(run.start_ns, run.rate_hz, samples);
        // Where the end was asked for while the arm stood, nothing goes out.
        if let Some(end) = self.act_on(|| listener.idle(0.0), run) {
            return Ok(end);
        }
        self.go_on(run)?;
        let mut settled = Vec::new();
        let (mut looked, mut complete) = (Instant::now(), None::<Instant>);
        loop {
            self.hear_state();
            if let Some(state) = self.state.as_ref().filter(|state| !self.settings.is_ready(state)) {
                return Err(LinkError::Aborted { reason: format!("it reports \"{state}\"") });
            }
            if looked.elapsed() > LOOK_EVERY {
                looked = Instant::now();
                self.look_around()?;
            }
            let standing = self.line.sender.poll()?;
            if standing.done && !run.whole_sent {
                return Err(LinkError::LatePiece { left_ms: 0.0, bound_ms: 1e3 * LEAST_LEFT_S });
            }
            if grid.is_done() {
                let waited = complete.get_or_insert_with(Instant::now).elapsed();
                if standing.done || !self.line.sender.tells_the_end() {
                    return Ok(End::Whole);
                }
                if waited > RESULT {
                    let (waited_ms, bound_ms) = (1e3 * waited.as_secs_f64(), 1e3 * RESULT.as_secs_f64());
                    return Err(LinkError::NoResult { waited_ms, bound_ms });
                }
            }
            if let Some((from, span)) = run.brake
                && self.motion_time(run) > from + span + 0.1
            {
                return Ok(End::Stop);
            }
            self.go_on(run)?;
            let Some(received) = self.line.states.next(PATIENCE) else {
                let age_s = alive.elapsed().as_secs_f64();
                if age_s > self.settings.patience_s {
                    let what = self.settings.full(&self.settings.joint_states);
                    return Err(self.line.endpoint.silence(what, None));
                }
                if let Some(end) = self.act_on(|| listener.idle(age_s), run) {
                    return Ok(end);
                }
                continue;
            };
            let at = received.at;
            let Some(row) = self.row(received)? else {
                // States of other joints are no states of the arm.
                if let Some(end) = self.act_on(|| listener.idle(alive.elapsed().as_secs_f64()), run) {
                    return Ok(end);
                }
                continue;
            };
            let arrival_s = at.duration_since(self.opened).as_secs_f64();
            let stamp = watch.see(row.stamp_ns, arrival_s);
            // A message that says nothing new is as good as none, and one that was long on its way is as old as that.
            let age_s = match stamp {
                Stamp::Fresh => {
                    self.latest = Some((row.clone(), at));
                    alive = at;
                    watch.lateness_s()
                }
                Stamp::Stale => alive.elapsed().as_secs_f64().max(watch.lateness_s()),
                Stamp::Jumped(by) => {
                    // The motion has gone on meanwhile: its time does, by the clock that there is now.
                    let before_s = self.motion_time(run);
                    self.latest = Some((row, at));
                    run.start_ns += ((self.motion_time(run) - before_s) * 1e9).round() as i64;
                    let reason = format!("its clock jumped by {by:.3} s; samples after it have no place in time");
                    return Err(LinkError::Aborted { reason });
                }
                Stamp::Drifted(by_s) => {
                    self.latest = Some((row, at));
                    // A motion under way need not follow a step of the clock: it may end as much later by that clock.
                    run.start_ns += (by_s.max(0.0) * 1e9).round() as i64;
                    let found = format!("advanced by {:.3} s while ours advanced by 1 s", 1.0 + by_s);
                    return Err(LinkError::Clock { found });
                }
            };
            if (stamp == Stamp::Stale || age_s * self.rate_hz > 1.0)
                && let Some(end) = self.act_on(|| listener.idle(age_s), run)
            {
                return Ok(end);
            }
            if stamp == Stamp::Stale {
                continue;
            }
            let (stamp_s, lateness_s) = (row.stamp_ns as f64 * 1e-9, watch.lateness_s());
            let state = ReceivedState { stamp_s, arrival_s, lateness_s, q: &row.q };
            if let Some(end) = self.act_on(|| listener.received(&state), run) {
                return Ok(end);
            }
            if self.line.sender.streams()
                && let Some(end) = self.stream(run, row.stamp_ns, at, listener)?
            {
                return Ok(end);
            }
            if row.stamp_ns < run.start_ns || grid.is_done() {
                let t = run.since_start(row.stamp_ns);
                let command = run.command(t).to_vec();
                if let Some(end) = self.act_on(|| listener.standing(t, &row, &command), run) {
                    return Ok(end);
                }
            }
            settled.clear();
            grid.push(row, &mut settled);
            for sample in settled.drain(..) {
                if run.brake.is_some() {
                    break;
                }
                if !sample.measured {
                    watch.miss(sample.index);
                }
                let command = run.command(sample.index as f64 / run.rate_hz).to_vec();
                if let Some(end) = self.act_on(|| listener.sample(&sample, &command), run) {
                    return Ok(end);
                }
            }
        }
    }

    /// Who else is there, and whether the middleware still works.
    fn look_around(&self) -> Result<(), LinkError> {
        if !self.line.endpoint.is_alive() {
            return Err(LinkError::Thread);
        }
        self.line.interference(&self.settings).map_or(Ok(()), |found| Err(LinkError::Interference(found)))
    }

    /// Hands over what is due: the whole motion, or its next piece.
    fn go_on(&mut self, run: &mut Run<'_>) -> Result<(), LinkError> {
        if self.line.sender.streams() || run.whole_sent {
            return Ok(());
        }
        let now_s = self.motion_time(run);
        if let Some((sent_s, full_until_s, _)) = run.piece {
            if now_s < sent_s + RENEW * (full_until_s - sent_s) {
                return Ok(());
            }
            let left_s = full_until_s - now_s;
            if left_s < LEAST_LEFT_S {
                return Err(LinkError::LatePiece { left_ms: 1e3 * left_s, bound_ms: 1e3 * LEAST_LEFT_S });
            }
        }
        let (motion, spacing_s) = (run.motion, self.settings.point_spacing_s);
        let next = if self.settings.horizon_s > 0.0 {
            piece(motion, &self.robot, spacing_s, now_s, self.settings.horizon_s)?
        } else {
            let duration_s = motion.duration_s();
            let points = points(motion, spacing_s)?;
            Piece { points, full_until_s: duration_s, rest_s: duration_s, is_last: true }
        };
        run.piece = Some((now_s, next.full_until_s, next.rest_s));
        run.whole_sent = next.is_last;
        let trajectory = JointTrajectory {
            header: Header { stamp: Time::from_ns(run.start_ns)?, frame_id: String::new() },
            joint_names: self.map.names().to_vec(),
            points: next.points,
        };
        self.line.sender.hand_over(trajectory, next.rest_s)
    }

    /// Streams the set-point that is due one message after the one with the stamp `stamp_ns`.
    fn stream(
        &mut self,
        run: &mut Run<'_>,
        stamp_ns: i64,
        due: Instant,
        listener: &mut dyn Listener,
    ) -> Result<Option<End>, LinkError> {
        let t = run.since_start(stamp_ns) + 1.0 / self.rate_hz;
        let set_point = run.command(t).to_vec();
        let end = self.act_on(|| listener.command(&set_point, due.elapsed().as_secs_f64()), run);
        if end.is_some() {
            return Ok(end);
        }
        // Where a stop has just begun, the set-point is on the motion still.
        self.line.sender.set_point(&set_point).map(|()| None)
    }

    /// Does what a listener says; while a stream brakes, it is not asked.
    fn act_on(&mut self, say: impl FnOnce() -> Flow, run: &mut Run<'_>) -> Option<End> {
        if run.brake.is_some() {
            return None;
        }
        match say() {
            Flow::Continue => None,
            Flow::Trip(action) => Some(End::Act(action)),
            // Before the motion begins there is nothing to brake: waiting for its beginning would only hold the arm up.
            Flow::Stop if self.line.sender.streams() && self.motion_time(run) > 0.0 => {
                let t = self.motion_time(run).min(run.motion.duration_s());
                run.command(t);
                run.brake = Some((t, stopping_time(&self.robot, &run.state[1])));
                None
            }
            Flow::Stop => Some(End::Stop),
        }
    }
}

/// What a panic says.
fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".to_owned())
}

/// Time in which every joint stops at half its acceleration limit, at least 0.1 s.
fn stopping_time(robot: &armid::model::Robot, qd: &[f64]) -> f64 {
    let longest = robot.joints().iter().zip(qd).map(|(joint, qd)| 2.0 * qd.abs() / joint.limits.acceleration);
    longest.fold(0.1, f64::max).min(2.0)
}
