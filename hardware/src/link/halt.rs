//! Bringing the arm to rest, reported only once it is observed.
//!
//! ```text
//! request ──→ repeated ──→ answered ──→ states stamped after the answer show rest ──→ Rest::Confirmed
//!               │ no state for a while, or an ended thread: a new participant asks too
//!               └── for as long as the motion could last, and TO_REST longer ──→ Rest::NotConfirmed
//! ```
//! How long that is counts by the robot's clock as well as by ours, whichever is slower: a robot whose controller stands still
//! now and then takes as much longer to stop.
//!
//! What counts as an answer: the robot controller carries the cancel out or has ended the motion; it says that the drives
//! are off; nothing that was handed over can move the arm any more, because its end is past; or, where there is no answer,
//! the arm stands although its motion would have moved it.
//!
//! A cancel covers the goals that were taken before it. A goal without an answer can still be carried out, so it counts as
//! under way until its end is past. A goal that is taken meanwhile is cancelled anew.

use std::time::{Duration, Instant};

use armid::experiment::{Rest, SafeAction};

use super::connection::Connection;
use super::follow::Run;
use super::rest::RestWatch;
use super::{LinkError, Ros2Arm};
use crate::message::{Header, JointTrajectory, Time, TrajectoryPoint};

/// How long the arm may take to come to rest once nothing moves it any more.
const TO_REST_S: f64 = 3.0;
/// Least rate of the robot's clock, in parts of ours, that is waited for: a slower one counts as running at this rate.
const SLOWEST: f64 = 0.1;
/// How soon a request is made again, and how often so before it is made more seldom.
const SOON: Duration = Duration::from_millis(20);
const OFTEN: usize = 10;
const SELDOM: Duration = Duration::from_millis(100);
/// Silence after which a fresh participant asks too, and how long it is given before the next one.
const SILENCE: Duration = Duration::from_millis(300);
const RETRY: Duration = Duration::from_secs(2);
/// How long to wait for the next state.
const PATIENCE: Duration = Duration::from_millis(2);
/// How long a hold on a topic takes, s: later it is out of date, and refused. It is repeated with the same end until then,
/// so that an arm that takes every one of them is not kept on its way.
const HOLD_S: f64 = 0.2;

/// What is known while the arm is brought to rest.
struct Halt {
    action: SafeAction,
    watch: RestWatch,
    answered: bool,
    /// Number of goals that were taken: another one is not covered by the answer.
    taken: usize,
    off: bool,
    /// When the newest state arrived.
    alive: Instant,
    asked: (usize, Option<Instant>),
    reopened: Option<Instant>,
    /// Position at which a topic is reported to hold, and from when on, by the motion's time, s.
    hold: (Vec<f64>, f64),
}

impl Ros2Arm {
    /// Asks for a safe action until the arm is seen at rest, or for as long as its motion could still last.
    pub(super) fn halt(&mut self, action: SafeAction, run: &mut Run<'_>) -> Rest {
        let began = Instant::now();
        let newest_ns = self.latest.as_ref().map_or(run.start_ns(), |(row, _)| row.stamp_ns);
        let now_s = self.motion_time(run);
        let left_s = if self.line.sender.streams() { 0.0 } else { (run.rest_s() - now_s).max(0.0) };
        let insist_s = left_s + TO_REST_S;
        let measured = self.latest.as_ref().map(|(row, _)| row.q.clone());
        let hold = measured.filter(|q| q.iter().all(|q| q.is_finite())).unwrap_or_else(|| run.command(now_s).to_vec());
        let watch = RestWatch::new(&self.robot, newest_ns);
        let (asked, reopened) = ((0, None), None);
        let (answered, off, hold) = (false, false, (hold, now_s));
        let mut halt =
            Halt { action, watch, answered, taken: self.line.sender.taken(), off, alive: began, asked, reopened, hold };
        // Nothing is outstanding where set-points just end, or before the first piece.
        let outstanding_ns =
            if self.line.sender.streams() || !run.is_handed_over() { newest_ns } else { run.stamp_ns(run.rest_s()) };
        loop {
            let (ours_s, robots_s) = (began.elapsed().as_secs_f64(), self.motion_time(run) - now_s);
            if ours_s.min(robots_s.max(SLOWEST * ours_s)) > insist_s {
                break;
            }
            self.ask(&mut halt, run);
            self.listen(&mut halt, run);
            if let Some(since_ns) = halt.watch.at_rest_since(halt.off)
                && (self.is_covered(&halt, run, since_ns)
                    || halt.off
                    || since_ns >= outstanding_ns
                    || self.holds_by_topic(&halt))
            {
                return Rest::Confirmed { after_ms: 1e3 * began.elapsed().as_secs_f64() };
            }
        }
        let open = self.line.sender.unanswered_until_s().is_some();
        let missing = if halt.alive.elapsed() > SILENCE {
            "no joint state has come since"
        } else if halt.watch.at_rest_since(halt.off).is_none() {
            "the arm was not seen at rest"
        } else if open {
            "the robot controller does not say whether it takes the last motion"
        } else {
            "the robot controller does not answer"
        };
        let reason = format!("{} repeated for {:.1} s, {missing}", action.name(), began.elapsed().as_secs_f64());
        Rest::NotConfirmed { reason }
    }

    /// Whether a cancel is carried out and no goal without an answer can move the arm after `since_ns`.
    fn is_covered(&self, halt: &Halt, run: &Run<'_>, since_ns: i64) -> bool {
        let open_s = self.line.sender.unanswered_until_s();
        halt.answered && open_s.is_none_or(|until_s| since_ns >= run.stamp_ns(until_s))
    }

    /// Whether a topic, which never answers, has plainly taken the hold.
    fn holds_by_topic(&self, halt: &Halt) -> bool {
        !self.line.sender.tells_the_end() && halt.watch.ignores_its_motion()
    }

    /// Time of the motion by the newest state and what has passed since, s.
    pub(super) fn motion_time(&self, run: &Run<'_>) -> f64 {
        let (row, at) = self.latest.as_ref().expect("a connected link has received a joint state");
        run.since_start(row.stamp_ns) + at.elapsed().as_secs_f64()
    }

    /// Makes the request where it is due, and opens a fresh participant where the old one is of no use.
    fn ask(&mut self, halt: &mut Halt, run: &Run<'_>) {
        let sender = &self.line.sender;
        let by_topic = !sender.streams() && !sender.tells_the_end();
        if by_topic && halt.action == SafeAction::Cancel && !run.is_handed_over() {
            // The request is a motion itself there: where none went out, this one does not either.
            return;
        }
        let (count, last) = halt.asked;
        let every = if count < OFTEN { SOON } else { SELDOM };
        if last.is_some_and(|last| last.elapsed() < every) {
            return;
        }
        halt.asked = (count + 1, Some(Instant::now()));
        let dead = !self.line.endpoint.is_alive();
        let now_s = self.motion_time(run);
        if now_s > halt.hold.1 + HOLD_S {
            halt.hold.1 = now_s;
        }
        let hold = self.hold_at(&halt.hold.0, run.stamp_ns(halt.hold.1));
        if !dead {
            // An error adds nothing: there is no better request than this one.
            let _ = act(&mut self.line, halt.action, hold.clone());
        }
        if let Some(rescue) = &mut self.rescue {
            let _ = act(rescue, halt.action, hold);
        }
        let useless = dead || halt.alive.elapsed() > SILENCE;
        if useless && halt.reopened.is_none_or(|reopened| reopened.elapsed() > RETRY) {
            halt.reopened = Some(Instant::now());
            self.rescue = Connection::open(&self.settings, "armid_rescue").ok();
        }
    }

    /// Takes what the robot says meanwhile.
    fn listen(&mut self, halt: &mut Halt, run: &mut Run<'_>) {
        let mut words = Vec::new();
        let mut received = Vec::new();
        let line = Some(&mut self.line).filter(|line| line.endpoint.is_alive());
        let connections: Vec<&mut Connection> = line.into_iter().chain(&mut self.rescue).collect();
        let patience = PATIENCE / connections.len().max(1) as u32;
        if connections.is_empty() {
            std::thread::sleep(PATIENCE);
        }
        let mut over = false;
        for connection in connections {
            // What else it says of the motion is of no matter now.
            over |= connection.sender.poll().is_ok_and(|standing| standing.over);
            words.extend(std::iter::from_fn(|| connection.status()));
            received.extend(connection.states.next(patience));
            received.extend(std::iter::from_fn(|| connection.states.take()));
        }
        for word in words {
            halt.off |= self.settings.off_states.iter().any(|off| word.starts_with(off.as_str()));
            self.state = Some(word);
        }
        if halt.taken != self.line.sender.taken() {
            halt.taken = self.line.sender.taken();
            (halt.answered, halt.asked) = (false, (0, None));
            for connection in std::iter::once(&mut self.line).chain(&mut self.rescue) {
                connection.sender.forget_cancels();
            }
        } else if over && !halt.answered {
            halt.answered = true;
            halt.watch.restart(self.latest.as_ref().map_or(i64::MIN, |(row, _)| row.stamp_ns));
        }
        for state in received {
            let Some(row) = state.message.ok().and_then(|message| self.map.positions(&message)) else { continue };
            if self.is_another(state.from) {
                continue;
            }
            let planned = run.command(run.since_start(row.stamp_ns)).to_vec();
            halt.watch.see(&row, &planned);
            halt.alive = state.at;
            if self.latest.as_ref().is_none_or(|(latest, _)| latest.stamp_ns < row.stamp_ns) {
                self.latest = Some((row, state.at));
            }
        }
    }

    /// The hold of a topic: a single point, out of date soon.
    fn hold_at(&self, q: &[f64], now_ns: i64) -> JointTrajectory {
        let zero = vec![0.0; q.len()];
        let point = TrajectoryPoint {
            positions: q.to_vec(),
            velocities: zero.clone(),
            accelerations: zero,
            effort: Vec::new(),
            time_from_start: Time::from_s(HOLD_S).expect("a hold is shorter than a message can say"),
        };
        // A hold goes out on any date: one that a message cannot hold (after 2038) becomes zero, which means at once.
        let header = Header { stamp: Time::from_ns(now_ns).unwrap_or_default(), frame_id: String::new() };
        JointTrajectory { header, joint_names: self.map.names().to_vec(), points: vec![point] }
    }
}

/// Makes a request; what is sent twice does no harm.
fn act(connection: &mut Connection, action: SafeAction, hold: JointTrajectory) -> Result<(), LinkError> {
    let cancelled = connection.sender.cancel(hold);
    if action == SafeAction::Disable {
        connection.disable()?;
    }
    cancelled
}
