//! Read-only monitoring of a moving robot: its states, their rate, and the state of the guard.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use armid::model::Robot;

use crate::GUARD_STATE;
use crate::guard::GuardState;
use crate::link::{Endpoint, Inbox, JointMap, JointRow, LinkError, LinkSettings, StampFindings, StampWatch};
use crate::message::{JointState, Text};

/// Time over which the rate is counted, s.
const RATE_S: f64 = 1.0;
/// Steps between stamps from which the period is taken.
const FIRST_STEPS: usize = 25;

/// Listens to a robot and to the guard around it, and commands nothing.
pub struct Monitor {
    // Keeps the node on the network.
    _endpoint: Endpoint,
    map: JointMap,
    states: Inbox<JointState>,
    controller_state: Option<Inbox<Text>>,
    guard: Inbox<Text>,
    began: Instant,
    arrivals: VecDeque<Instant>,
    /// Steps of the first stamps, ns: their median is the period by which gaps are reported.
    steps: Vec<i64>,
    stamps: Option<StampWatch>,
    snapshot: Snapshot,
    received: Option<Instant>,
    guard_received: Option<Instant>,
}

/// What a monitor sees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The last joint state.
    pub row: Option<JointRow>,
    /// How long ago it arrived, s.
    pub age_s: f64,
    /// Joint states in the last second.
    pub rate_hz: f64,
    /// What the stamps showed so far.
    pub stamps: StampFindings,
    /// The state of the robot controller in words, where it reports one.
    pub controller_state: Option<String>,
    /// The last report of a guard, and its age, s.
    pub guard: Option<(GuardState, f64)>,
    /// The last message that made no sense, in words.
    pub fault: Option<String>,
}

impl Monitor {
    /// Joins the robot's domain.
    ///
    /// # Errors
    /// [`LinkError`] where a setting is impossible or the network refuses.
    pub fn open(settings: &LinkSettings, robot: &Robot) -> Result<Self, LinkError> {
        let names: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let mut map = JointMap::new(&names, settings)?;
        map.pass_over_others();
        let mut endpoint = Endpoint::join(settings, "armid_monitor")?;
        let (text, qos) = (("std_msgs", "String"), settings.monitor_qos());
        let topic = settings.full(&settings.joint_states);
        let states = endpoint.subscription(&topic, ("sensor_msgs", "JointState"), &qos)?;
        let states = Inbox::new("joint states", states)?;
        let controller_state = if settings.robot_state.is_empty() {
            None
        } else {
            let topic = settings.full(&settings.robot_state);
            Some(Inbox::new("robot state", endpoint.subscription(&topic, text, &qos)?)?)
        };
        let guard = endpoint.subscription(&settings.full(GUARD_STATE), text, &qos)?;
        Ok(Self {
            _endpoint: endpoint,
            map,
            states,
            controller_state,
            guard: Inbox::new("guard state", guard)?,
            began: Instant::now(),
            arrivals: VecDeque::new(),
            steps: Vec::new(),
            stamps: None,
            snapshot: Snapshot::default(),
            received: None,
            guard_received: None,
        })
    }

    fn see(&mut self, stamp_ns: i64, at: Instant) {
        if let Some(watch) = &mut self.stamps {
            watch.see(stamp_ns, at.duration_since(self.began).as_secs_f64());
        } else {
            self.steps.extend(self.snapshot.row.as_ref().map(|last| stamp_ns - last.stamp_ns));
            if self.steps.len() == FIRST_STEPS {
                self.steps.sort_unstable();
                self.stamps = Some(StampWatch::new(self.steps[FIRST_STEPS / 2] as f64 * 1e-9));
            }
        }
    }

    /// Listens for `patience`, and returns what was received.
    pub fn look(&mut self, patience: Duration) -> &Snapshot {
        let until = Instant::now() + patience;
        while let Some(left) = until.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
            let Some(received) = self.states.next(left) else { break };
            match received.message.and_then(|message| self.map.row(&message).map_err(|error| error.to_string())) {
                Ok(None) => continue,
                Ok(Some(row)) => {
                    self.see(row.stamp_ns, received.at);
                    self.arrivals.push_back(received.at);
                    self.snapshot.row = Some(row);
                }
                Err(fault) => self.snapshot.fault = Some(fault),
            }
            self.received = Some(received.at);
        }
        while let Some(received) = self.controller_state.as_ref().and_then(Inbox::take) {
            if let Ok(text) = received.message {
                self.snapshot.controller_state = Some(text.data);
            }
        }
        while let Some(received) = self.guard.take() {
            match received.message.and_then(|text| serde_json::from_str(&text.data).map_err(|error| error.to_string()))
            {
                Ok(state) => {
                    self.snapshot.guard = Some((state, 0.0));
                    self.guard_received = Some(received.at);
                }
                Err(fault) => self.snapshot.fault = Some(format!("guard state: {fault}")),
            }
        }
        let now = Instant::now();
        let age = |received: Option<Instant>| received.map_or(f64::INFINITY, |at| now.duration_since(at).as_secs_f64());
        while self.arrivals.front().is_some_and(|at| now.duration_since(*at).as_secs_f64() > RATE_S) {
            self.arrivals.pop_front();
        }
        let counted = now.duration_since(self.began).as_secs_f64().clamp(1e-3, RATE_S);
        self.snapshot.rate_hz = self.arrivals.len() as f64 / counted;
        self.snapshot.age_s = age(self.received);
        self.snapshot.stamps = self.stamps.as_ref().map(|watch| watch.findings().clone()).unwrap_or_default();
        let guard_age = age(self.guard_received);
        if let Some((_, age)) = &mut self.snapshot.guard {
            *age = guard_age;
        }
        &self.snapshot
    }
}
