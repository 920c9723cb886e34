//! A robot on the other side of a ROS 2 network, as an arm.

use std::time::{Duration, Instant};

use armid::experiment::{
    Arm, ArmError, Ending, ExperimentPlan, Flow, Layout, Phase, RawSample, ReceivedState, Recording, SafeAction, Sink,
    TripReport,
};
use armid::model::Robot;
use ros2_client::Publisher;
use ros2_client::gid::Gid;

use super::clock::{ClockWatch, FOUND_S};
use super::connection::Connection;
use super::follow::{Followed, Listener};
use super::node::{Asked, Patience};
use super::states::Received;
use super::{GridSample, JointMap, JointRow, LinkError, LinkSettings, PlanMotion, StampFindings};
use crate::guard::{LOOK_MS, REACTION_MS, Trip};
use crate::message::{FollowFeedback, JointState, Text};

/// Messages by which the robot's rate is measured before anything moves.
const RATE_MESSAGES: usize = 25;

/// How long it takes until everybody on the network has been found.
const FOUND: Duration = Duration::from_millis(1000);

/// How long the robot's clock has to run as ours does before anything moves: a machine that has just begun may be late.
const CLOCK: Duration = Duration::from_secs(6);

/// What the robot said last.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its joints.
    pub row: JointRow,
    /// How long ago that arrived, by the local monotonic clock, s.
    pub age_s: f64,
    /// How often joint states come by their own stamps, Hz.
    pub rate_hz: f64,
    /// The state of its controller in words, where it reports one.
    pub state: Option<String>,
}

/// A robot that is reached over ROS 2. Only this crate can make one, so every command to it passes the guard.
///
/// It follows a motion that is handed over or streamed, and yields the joint states that arrive, resampled onto
/// the plan's grid (see [`super::Resampler`]). Where the link fails in the middle, the motion is cancelled and the
/// experiment ends as tripped, with every sample up to there.
pub struct Ros2Arm {
    pub(super) line: Connection,
    /// A second participant, where the first is of no use any more.
    pub(super) rescue: Option<Connection>,
    pub(super) settings: LinkSettings,
    pub(super) robot: Robot,
    robot_text: String,
    pub(super) map: JointMap,
    /// When the link was opened: arrivals count from here.
    pub(super) opened: Instant,
    pub(super) clock: ClockWatch,
    /// Who reports the arm's joints.
    pub(super) source: Option<Gid>,
    pub(super) rate_hz: f64,
    pub(super) latest: Option<(JointRow, Instant)>,
    pub(super) state: Option<String>,
    asked: Asked,
    pub(super) findings: StampFindings,
}

impl Ros2Arm {
    /// Finds the robot on the network, checks the names of its joints and measures how often it reports them.
    ///
    /// # Errors
    /// [`LinkError`] where a setting is impossible, there is no answer, or the joints are not those of the robot file;
    /// [`LinkError::Interference`] where more than one robot answers, or another client commands it.
    pub(crate) fn connect(settings: &LinkSettings, robot: &Robot, robot_text: &str) -> Result<Self, LinkError> {
        Self::find(settings, robot, robot_text, || false)
    }

    /// Finds the robot as [`Self::connect`] does, unless the operator asks for the end.
    ///
    /// # Errors
    /// Those of [`Self::connect`], and [`LinkError::Interrupted`].
    pub(crate) fn find(
        settings: &LinkSettings,
        robot: &Robot,
        robot_text: &str,
        asked: Asked,
    ) -> Result<Self, LinkError> {
        let names: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let map = JointMap::new(&names, settings)?;
        let line = Connection::open(settings, "armid")?;
        line.wait(settings, asked)?;
        let mut arm = Self {
            line,
            rescue: None,
            settings: settings.clone(),
            robot: robot.clone(),
            robot_text: robot_text.to_owned(),
            map,
            opened: Instant::now(),
            clock: ClockWatch::default(),
            source: None,
            rate_hz: 0.0,
            latest: None,
            state: None,
            asked,
            findings: StampFindings::default(),
        };
        arm.rate_hz = arm.measure_rate()?;
        arm.await_others()?;
        arm.map.pass_over_others();
        Ok(arm)
    }

    /// Waits for what others have to say before anything moves: everybody who is on the network has been found after a
    /// while, the robot's state has arrived where it is published, even if only once and long ago, and its clock runs as ours
    /// does.
    fn await_others(&mut self) -> Result<(), LinkError> {
        let settings = self.settings.clone();
        let patience = Patience::new(&settings, self.asked);
        loop {
            while self.receive(Duration::ZERO)? {}
            if let Some(found) = self.line.interference(&self.settings) {
                return Err(LinkError::Interference(found));
            }
            // What is said of goals counts at the end: until then it may be what was said long ago.
            let polled = self.line.sender.poll();
            let says = self.line.says_its_state(&self.settings);
            let (said, alike) = (self.state.is_some() || !says, self.clock.agree_s() > FOUND_S);
            if patience.elapsed() > FOUND && said && alike {
                return match polled {
                    Err(stranger @ LinkError::Interference(_)) => Err(stranger),
                    _ => Ok(()),
                };
            }
            if !alike && patience.elapsed() > CLOCK {
                let (robots_s, ours_s) = self.clock.progress();
                let found = format!("advanced by {robots_s:.2} s while ours advanced by {ours_s:.2} s");
                return Err(LinkError::Clock { found });
            }
            if !said {
                patience.left(|| format!("a state on {}", settings.full(&settings.robot_state)))?;
            } else if (self.asked)() {
                return Err(LinkError::Interrupted);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Whether the request `disable` has a subscriber.
    pub(crate) fn can_disable(&self) -> bool {
        self.line.takes_requests(&self.settings)
    }

    /// The words with which the arm may move.
    pub(crate) fn ready_states(&self) -> &[String] {
        &self.settings.ready_states
    }

    /// The median rate of the joint states by their stamps, Hz.
    fn measure_rate(&mut self) -> Result<f64, LinkError> {
        let settings = self.settings.clone();
        let topic = settings.full(&settings.joint_states);
        let patience = Patience::new(&settings, self.asked);
        let mut steps = Vec::with_capacity(RATE_MESSAGES);
        let mut messages = 0;
        while steps.len() < RATE_MESSAGES {
            let last = self.latest.as_ref().map(|(row, _)| row.stamp_ns);
            if self.receive(Duration::from_millis(5))? {
                messages += 1;
                let stamp = self.latest.as_ref().map(|(row, _)| row.stamp_ns);
                if let (Some(last), Some(stamp)) = (last, stamp)
                    && stamp > last
                {
                    steps.push(stamp - last);
                }
            }
            if let Err(silence) = patience.left(|| format!("{RATE_MESSAGES} messages on {topic}")) {
                return Err(match (last, messages, steps.len(), silence) {
                    (Some(stamp), RATE_MESSAGES.., 0, LinkError::Silence { .. }) => {
                        LinkError::Stamps { topic, messages, stamp_s: stamp as f64 * 1e-9 }
                    }
                    (_, _, _, silence) => silence,
                });
            }
        }
        steps.sort_unstable();
        Ok(1e9 / steps[steps.len() / 2] as f64)
    }

    /// Takes the next joint state, waiting for `patience` at most, and every state of the robot controller.
    fn receive(&mut self, patience: Duration) -> Result<bool, LinkError> {
        self.hear_state();
        let Some(received) = self.line.states.next(patience) else { return Ok(false) };
        let at = received.at;
        if let Some(row) = self.row(received)? {
            // Whether the clocks agree is asked before anything moves.
            let _ = self.clock.see(row.stamp_ns, at.duration_since(self.opened).as_secs_f64());
            self.latest = Some((row, at));
        }
        Ok(true)
    }

    /// What a message says of the arm's joints; none where it is about others.
    ///
    /// # Errors
    /// [`LinkError`] where it cannot be read or its joints are wrong; [`LinkError::Interference`] where a second robot
    /// reports joints with the same names.
    pub(super) fn row(&mut self, received: Received<JointState>) -> Result<Option<JointRow>, LinkError> {
        let message =
            received.message.map_err(|reason| LinkError::Middleware { what: "joint state".to_owned(), reason })?;
        let row = self.map.row(&message)?;
        if row.is_some() && self.is_another(received.from) {
            let topic = self.settings.full(&self.settings.joint_states);
            let what = format!("2 others report joint states of the arm on {topic}, expected 1");
            return Err(LinkError::Interference(what));
        }
        Ok(row)
    }

    /// Whether joint states of the arm come from another publisher than before, which is still there.
    pub(super) fn is_another(&mut self, from: Gid) -> bool {
        let source = *self.source.get_or_insert(from);
        let another = source != from && self.line.endpoint.has_writer(source);
        if !another {
            self.source = Some(from);
        }
        another
    }

    /// Takes every reported state of the robot controller.
    pub(super) fn hear_state(&mut self) {
        while let Some(state) = self.line.status() {
            // A state that forbids the motion stays: a second one that allows it may be of another controller.
            if self.state.as_ref().is_none_or(|state| self.settings.is_ready(state)) {
                self.state = Some(state);
            }
        }
    }

    /// Where the arm stands now: the newest joint state.
    ///
    /// # Errors
    /// [`LinkError`] where none comes in time, or its joints are not those of the robot file.
    pub(crate) fn reading(&mut self) -> Result<Reading, LinkError> {
        self.latest = None;
        let settings = self.settings.clone();
        let patience = Patience::new(&settings, self.asked);
        while self.receive(Duration::ZERO)? || self.latest.is_none() {
            if self.latest.is_none() {
                self.receive(Duration::from_millis(5))?;
            }
            patience.left(|| settings.full(&settings.joint_states))?;
        }
        let (row, at) = self.latest.clone().expect("the loop ends with one");
        Ok(Reading { row, age_s: at.elapsed().as_secs_f64(), rate_hz: self.rate_hz, state: self.state.clone() })
    }

    /// The newest joint state that has come, and when: without waiting, so that a caller that follows the arm learns of a
    /// silence that has begun.
    ///
    /// # Errors
    /// [`LinkError`] where its joints are not those of the robot file.
    pub(super) fn newest(&mut self) -> Result<(JointRow, Instant), LinkError> {
        while self.receive(Duration::ZERO)? {}
        Ok(self.latest.clone().expect("a connected link has measured the rate of the joint states"))
    }

    /// The ROS domain that it was found in.
    pub fn domain(&self) -> u16 {
        self.line.endpoint.domain()
    }

    /// How often its joint states come by their own stamps, Hz.
    pub(crate) const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// A publisher of text on `topic`, by which others learn what happens here.
    pub(crate) fn status_publisher(&mut self, topic: &str) -> Result<Publisher<Text>, LinkError> {
        self.line.endpoint.publisher(topic, ("std_msgs", "String"), &self.settings.report_qos())
    }

    /// The robot that this is.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// How far the robot controller says that its joints are from the motion, in its own order; `None` where it reports
    /// nothing, as in the modes without an action.
    pub fn feedback(&self) -> Option<&FollowFeedback> {
        self.line.sender.feedback()
    }

    /// What the stamps of the last motion showed.
    pub fn findings(&self) -> &StampFindings {
        &self.findings
    }

    /// What a recording of a plan begins with.
    pub(crate) fn recording(&self, plan: &ExperimentPlan, layout: &Layout) -> Recording {
        Recording::empty(&self.robot, &self.robot_text, plan, layout, None)
    }
}

/// Looks at a robot without moving it: where it stands, the rate of its joint states, the state of its controller.
///
/// # Errors
/// [`LinkError`] where there is no answer, or the joints are not those of the robot file.
pub fn look(settings: &LinkSettings, robot: &Robot) -> Result<Reading, LinkError> {
    Ros2Arm::connect(settings, robot, "")?.reading()
}

/// The ending of a motion that was not performed to its end.
pub(crate) fn ending(followed: Followed, t: f64, phase: Phase) -> Ending {
    let (error, rest) = match followed {
        Followed::Whole => return Ending::Completed,
        Followed::Stopped(rest) | Followed::Acted(_, rest) => return Ending::Stopped { t, phase, rest },
        Followed::Failed(error, rest) => (error, rest),
    };
    let (trip, bound_ms) = match &error {
        LinkError::Aborted { .. } | LinkError::Refused { .. } | LinkError::Clock { .. } => {
            (Trip::RobotStopped, REACTION_MS)
        }
        LinkError::Interference(_) => (Trip::Interference, LOOK_MS + REACTION_MS),
        LinkError::NoAcceptance { bound_ms, .. } => (Trip::NoAcceptance, bound_ms + REACTION_MS),
        LinkError::NoResult { bound_ms, .. } => (Trip::NoResult, bound_ms + REACTION_MS),
        LinkError::Panic(_) => (Trip::Panic, REACTION_MS),
        LinkError::Thread => (Trip::Link, LOOK_MS + REACTION_MS),
        LinkError::LatePiece { .. }
        | LinkError::Setting { .. }
        | LinkError::Middleware { .. }
        | LinkError::Cdr(_)
        | LinkError::Silence { .. }
        | LinkError::Interrupted
        | LinkError::Network(_)
        | LinkError::Stamps { .. }
        | LinkError::Joints { .. }
        | LinkError::Length { .. } => (Trip::Link, REACTION_MS),
    };
    // The trip's name says it already.
    let reason = if let LinkError::Interference(found) = error { found } else { error.to_string() };
    let (trip, action) = (trip.name(), SafeAction::Cancel);
    Ending::Tripped { t, phase, trip: Box::new(TripReport { trip, action, bound_ms, reason, rest }) }
}

/// Hands the samples of a plan on to its sink.
struct Relay<'a> {
    sink: &'a mut dyn Sink,
    layout: &'a Layout,
    rate_hz: f64,
    last: (f64, Phase),
}

impl Listener for Relay<'_> {
    fn sample(&mut self, sample: &GridSample, command: &[f64]) -> Flow {
        let (index, t, phase) = (sample.index, sample.index as f64 / self.rate_hz, self.layout.phase(sample.index));
        self.last = (t, phase);
        self.sink.sample(&RawSample {
            index,
            t,
            phase,
            q: &sample.q,
            effort: &sample.effort,
            voltage: &[],
            link_q: &[],
            command,
        })
    }

    fn standing(&mut self, t: f64, row: &JointRow, command: &[f64]) -> Flow {
        let index = if t < 0.0 { 0 } else { self.layout.samples() - 1 };
        self.last = (t, self.layout.phase(index));
        let (q, effort) = (&row.q, &row.effort);
        self.sink.unrecorded(&RawSample { index, t, phase: self.last.1, q, effort, voltage: &[], link_q: &[], command })
    }

    fn received(&mut self, state: &ReceivedState<'_>) -> Flow {
        self.sink.received(state)
    }

    fn idle(&mut self, age_s: f64) -> Flow {
        self.sink.idle(age_s)
    }

    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        self.sink.command(set_point, age_s)
    }
}

impl Arm for Ros2Arm {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let layout = plan.check(self.robot.dof())?;
        let unavailable = |reason: String| ArmError::Unavailable { arm: "ros2".to_owned(), reason };
        if plan.rate_hz > 1.01 * self.rate_hz {
            let reason =
                format!("joint states come at {:.1} Hz, the plan samples at {} Hz", self.rate_hz, plan.rate_hz);
            return Err(unavailable(reason));
        }
        self.newest().map_err(|error| unavailable(error.to_string()))?;
        self.hear_state();
        if let Some(state) = self.state.as_ref().filter(|state| !self.settings.is_ready(state)) {
            let expected = self.settings.ready_states.join("\", \"");
            return Err(unavailable(format!("the robot controller reports \"{state}\", expected \"{expected}\"")));
        }
        sink.begin(&self.recording(plan, &layout));
        let mut relay = Relay { sink, layout: &layout, rate_hz: plan.rate_hz, last: (0.0, layout.phase(0)) };
        let motion = PlanMotion::new(plan, &layout, plan.trajectory.dof());
        let followed = self.follow(&motion, plan.rate_hz, &mut relay);
        let (t, phase) = relay.last;
        Ok(ending(followed, t, phase))
    }
}
