//! A robot on the other side of a ROS 2 network, as an arm.

use std::time::{Duration, Instant};

use armid::experiment::{
    Arm, ArmError, Ending, ExperimentPlan, Flow, Layout, Phase, RawSample, Recording, SafeAction, Sink, TripReport,
};
use armid::model::Robot;
use armid::provenance::Provenance;
use ros2_client::Publisher;

use super::follow::{Followed, Listener};
use super::node::Other;
use super::sender::Sender;
use super::states::Inbox;
use super::{Endpoint, GridSample, JointMap, JointRow, LinkError, LinkSettings, PlanMotion, StampFindings};
use crate::guard::{REACTION_MS, Trip};
use crate::message::{FollowFeedback, JointState, Text};

/// Messages by which the robot's rate is measured before anything moves.
const RATE_MESSAGES: usize = 25;

/// How long a robot's computer may take to say its first word.
const WORD: Duration = Duration::from_secs(2);

/// What the robot said last.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its joints.
    pub row: JointRow,
    /// How long ago that arrived, by the local monotonic clock, s.
    pub age_s: f64,
    /// How often joint states come by their own stamps, Hz.
    pub rate_hz: f64,
    /// The state of its computer in words, where it tells.
    pub state: Option<String>,
}

/// A robot that speaks ROS 2. Only this crate can make one, so every command to it passes the guard.
///
/// It follows a motion that is handed over whole or streamed, and yields the joint states that arrive, resampled onto
/// the plan's grid (see [`super::Resampler`]). Where the link fails in the middle, the motion is cancelled and the
/// experiment ends as tripped by `link`, with every sample up to there.
pub struct Ros2Arm {
    /// Keeps the node on the network.
    endpoint: Endpoint,
    pub(super) settings: LinkSettings,
    pub(super) robot: Robot,
    robot_text: String,
    pub(super) map: JointMap,
    pub(super) inbox: Inbox<JointState>,
    states: Option<Inbox<Text>>,
    request: Option<Publisher<Text>>,
    pub(super) sender: Sender,
    pub(super) rate_hz: f64,
    pub(super) latest: Option<(JointRow, Instant)>,
    pub(super) state: Option<String>,
    pub(super) findings: StampFindings,
}

impl Ros2Arm {
    /// Finds the robot on the network, checks the names of its joints and measures how often it reports them.
    ///
    /// # Errors
    /// [`LinkError`] where a setting is impossible, nobody answers, or the joints are not those of the robot file.
    pub(crate) fn connect(settings: &LinkSettings, robot: &Robot, robot_text: &str) -> Result<Self, LinkError> {
        let names: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let map = JointMap::new(&names, settings)?;
        let mut endpoint = Endpoint::join(settings, "armid")?;
        let topic = settings.full(&settings.joint_states);
        let subscription = endpoint.subscription(&topic, ("sensor_msgs", "JointState"), &settings.state_qos())?;
        endpoint.wait(&topic, &[(Other::Writer, format!("rt{topic}"))])?;
        let inbox = Inbox::new("joint states", subscription)?;
        let text = ("std_msgs", "String");
        let states = if settings.robot_state.is_empty() {
            None
        } else {
            let topic = settings.full(&settings.robot_state);
            Some(Inbox::new("robot state", endpoint.subscription(&topic, text, &settings.command_qos())?)?)
        };
        let request = if settings.robot_request.is_empty() {
            None
        } else {
            Some(endpoint.publisher(&settings.full(&settings.robot_request), text, &settings.command_qos())?)
        };
        let sender = Sender::open(&mut endpoint, settings)?;
        sender.wait(&endpoint, settings)?;
        let mut arm = Self {
            endpoint,
            settings: settings.clone(),
            robot: robot.clone(),
            robot_text: robot_text.to_owned(),
            map,
            inbox,
            states,
            request,
            sender,
            rate_hz: 0.0,
            latest: None,
            state: None,
            findings: StampFindings::default(),
        };
        arm.rate_hz = arm.measure_rate()?;
        arm.await_word();
        Ok(arm)
    }

    /// Waits for the first word about the state of the robot's computer where somebody is there to say one: an arm that
    /// is stopped or not homed must not move because its joint states came first.
    fn await_word(&mut self) {
        let speaker = [(Other::Writer, format!("rt{}", self.settings.full(&self.settings.robot_state)))];
        let began = Instant::now();
        while self.state.is_none() && began.elapsed() < WORD && self.states.is_some() && self.endpoint.has(&speaker) {
            std::thread::sleep(Duration::from_millis(5));
            self.hear_state();
        }
    }

    /// The median rate of the joint states by their stamps, Hz.
    fn measure_rate(&mut self) -> Result<f64, LinkError> {
        let topic = self.settings.full(&self.settings.joint_states);
        let mut steps = Vec::with_capacity(RATE_MESSAGES);
        let began = Instant::now();
        while steps.len() < RATE_MESSAGES {
            let last = self.latest.as_ref().map(|(row, _)| row.stamp_ns);
            if self.hear(Duration::from_millis(5))? {
                let stamp = self.latest.as_ref().map(|(row, _)| row.stamp_ns);
                if let (Some(last), Some(stamp)) = (last, stamp)
                    && stamp > last
                {
                    steps.push(stamp - last);
                }
            } else if began.elapsed() > self.settings.patience() {
                let (waited_s, domain) = (self.settings.patience_s, self.settings.domain);
                return Err(LinkError::Silence {
                    what: format!("{RATE_MESSAGES} messages on {topic}"),
                    waited_s,
                    domain,
                });
            }
        }
        steps.sort_unstable();
        Ok(1e9 / steps[steps.len() / 2] as f64)
    }

    /// Takes the next joint state, waiting for `patience` at most, and every word about the robot's computer.
    fn hear(&mut self, patience: Duration) -> Result<bool, LinkError> {
        self.hear_state();
        let Some(heard) = self.inbox.next(patience) else { return Ok(false) };
        let message =
            heard.message.map_err(|reason| LinkError::Middleware { what: "joint state".to_owned(), reason })?;
        self.latest = Some((self.map.row(&message)?, heard.at));
        Ok(true)
    }

    /// Takes every word about the state of the robot's computer.
    pub(super) fn hear_state(&mut self) {
        while let Some(heard) = self.states.as_ref().and_then(Inbox::take) {
            if let Ok(text) = heard.message {
                self.state = Some(text.data);
            }
        }
    }

    /// Where the arm stands now: the newest joint state.
    ///
    /// # Errors
    /// [`LinkError`] where none comes in time, or its joints are not those of the robot file.
    pub(crate) fn reading(&mut self) -> Result<Reading, LinkError> {
        self.latest = None;
        let began = Instant::now();
        while self.hear(Duration::ZERO)? || self.latest.is_none() {
            if self.latest.is_none() {
                self.hear(Duration::from_millis(5))?;
            }
            if began.elapsed() > self.settings.patience() {
                let what = self.settings.full(&self.settings.joint_states);
                let (waited_s, domain) = (self.settings.patience_s, self.settings.domain);
                return Err(LinkError::Silence { what, waited_s, domain });
            }
        }
        let (row, at) = self.latest.clone().expect("the loop ends with one");
        Ok(Reading { row, age_s: at.elapsed().as_secs_f64(), rate_hz: self.rate_hz, state: self.state.clone() })
    }

    /// The newest joint state that has come, and when: without waiting, so that whoever follows the arm hears of a
    /// silence that has begun.
    ///
    /// # Errors
    /// [`LinkError`] where its joints are not those of the robot file.
    pub(super) fn newest(&mut self) -> Result<(JointRow, Instant), LinkError> {
        while self.hear(Duration::ZERO)? {}
        Ok(self.latest.clone().expect("whoever is connected has measured the rate of the joint states"))
    }

    /// The ROS domain that it was found in.
    #[must_use]
    pub fn domain(&self) -> u16 {
        self.endpoint.domain()
    }

    /// How often its joint states come by their own stamps, Hz.
    pub(crate) const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// A topic on which to tell others in words what happens here.
    pub(crate) fn teller(&mut self, topic: &str) -> Result<Publisher<Text>, LinkError> {
        self.endpoint.publisher(topic, ("std_msgs", "String"), &self.settings.telling_qos())
    }

    /// The robot that this is.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// How far the robot's computer says that its joints are from the motion, in its own order; `None` where it tells
    /// nothing, as in the modes without an action.
    #[must_use]
    pub fn feedback(&self) -> Option<&FollowFeedback> {
        self.sender.feedback()
    }

    /// What the stamps of the last motion told.
    #[must_use]
    pub fn findings(&self) -> &StampFindings {
        &self.findings
    }

    /// Takes a safe action at once; what is sent twice does no harm.
    ///
    /// # Errors
    /// [`LinkError`] where it cannot even be sent.
    pub(crate) fn act(&mut self, action: SafeAction) -> Result<(), LinkError> {
        let cancelled = self.sender.cancel();
        if action == SafeAction::Disable
            && let Some(request) = &self.request
        {
            let word = Text { data: "disable".to_owned() };
            request.publish(word).map_err(|error| LinkError::middleware("disable", &error.forget_data()))?;
        }
        cancelled
    }

    /// What a recording of a plan begins with.
    pub(crate) fn recording(&self, plan: &ExperimentPlan, layout: &Layout) -> Recording {
        Recording {
            robot: self.robot.name().to_owned(),
            robot_text: self.robot_text.clone(),
            dof: self.robot.dof(),
            rate_hz: plan.rate_hz,
            joints: self.robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            effort_unit: self.robot.effort(),
            phases: layout.spans.clone(),
            trajectory: plan.trajectory.clone(),
            period_samples: layout.period_samples,
            t: Vec::new(),
            q: Vec::new(),
            effort: Vec::new(),
            voltage: Vec::new(),
            provenance: Provenance::new(self.robot.name(), &self.robot_text, None),
        }
    }
}

/// Looks at a robot without moving it: where it stands, how often it says so, the state of its computer.
///
/// # Errors
/// [`LinkError`] where nobody answers or the joints are not those of the robot file.
pub fn look(settings: &LinkSettings, robot: &Robot) -> Result<Reading, LinkError> {
    Ros2Arm::connect(settings, robot, "")?.reading()
}

/// The ending of a motion that the robot's computer gave up or the link lost. It was cancelled.
pub(crate) fn tripped(error: &LinkError, t: f64, phase: Phase) -> Ending {
    let trip = match error {
        LinkError::Aborted { .. } | LinkError::Refused { .. } => Trip::RobotStopped,
        _ => Trip::Link,
    };
    let (trip, action, bound_ms, reason) = (trip.name(), SafeAction::Cancel, REACTION_MS, error.to_string());
    Ending::Tripped { t, phase, trip: Box::new(TripReport { trip, action, bound_ms, reason }) }
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
        self.sink.sample(&RawSample { index, t, phase, q: &sample.q, effort: &sample.effort, voltage: &[], command })
    }

    fn standing(&mut self, t: f64, row: &JointRow, command: &[f64]) -> Flow {
        let index = if t < 0.0 { 0 } else { self.layout.samples() - 1 };
        self.last = (t, self.layout.phase(index));
        let (q, effort) = (&row.q, &row.effort);
        self.sink.unrecorded(&RawSample { index, t, phase: self.last.1, q, effort, voltage: &[], command })
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
        if let Some(state) = self.state.as_ref().filter(|state| !super::follow::is_enabled(state)) {
            return Err(unavailable(format!("the robot's computer says \"{state}\", expected \"enabled\"")));
        }
        sink.begin(&self.recording(plan, &layout));
        let mut relay = Relay { sink, layout: &layout, rate_hz: plan.rate_hz, last: (0.0, layout.phase(0)) };
        let motion = PlanMotion::new(plan, &layout, plan.trajectory.dof());
        let followed = self.follow(&motion, plan.rate_hz, &mut relay);
        let (t, phase) = relay.last;
        Ok(match followed {
            Ok(Followed::Whole) => Ending::Completed,
            Ok(Followed::Stopped | Followed::Acted(_)) => Ending::Stopped { t, phase },
            Err(error) => tripped(&error, t, phase),
        })
    }
}
