//! Everything by which one participant reaches the robot.

use ros2_client::Publisher;
use ros2_client::qos::Durability;

use super::node::{Asked, Peer};
use super::sender::Sender;
use super::states::Inbox;
use super::{Endpoint, LinkError, LinkSettings, Mode};
use crate::message::{JointState, Text};

/// A participant with its topics.
pub(crate) struct Connection {
    pub(crate) endpoint: Endpoint,
    pub(crate) states: Inbox<JointState>,
    /// The robot's state as text, as it comes and as it was published before this subscription.
    words: Vec<Inbox<Text>>,
    request: Option<Publisher<Text>>,
    pub(crate) sender: Sender,
}

impl Connection {
    /// Joins the network, without waiting for other participants.
    ///
    /// # Errors
    /// [`LinkError`] where a setting is impossible or the network refuses.
    pub(crate) fn open(settings: &LinkSettings, node: &str) -> Result<Self, LinkError> {
        let mut endpoint = Endpoint::join(settings, node)?;
        let topic = settings.full(&settings.joint_states);
        let states = endpoint.subscription(&topic, ("sensor_msgs", "JointState"), &settings.state_qos())?;
        let text = ("std_msgs", "String");
        let mut words = Vec::new();
        if !settings.robot_state.is_empty() {
            let topic = settings.full(&settings.robot_state);
            // A transient-local reader does not match a volatile writer, so there are two.
            for durability in [Durability::Volatile, Durability::TransientLocal] {
                let qos = settings.command_qos().durability(durability);
                words.push(Inbox::new("robot state", endpoint.subscription(&topic, text, &qos)?)?);
            }
        }
        let request = if settings.robot_request.is_empty() {
            None
        } else {
            Some(endpoint.publisher(&settings.full(&settings.robot_request), text, &settings.command_qos())?)
        };
        let sender = Sender::open(&mut endpoint, settings)?;
        Ok(Self { endpoint, states: Inbox::new("joint states", states)?, words, request, sender })
    }

    /// Waits until a robot reports joints and accepts motions.
    pub(crate) fn wait(&self, settings: &LinkSettings, asked: Asked) -> Result<(), LinkError> {
        let topic = settings.full(&settings.joint_states);
        self.endpoint.wait(&topic, &[(Peer::Writer, format!("rt{topic}"))], asked)?;
        self.sender.wait(&self.endpoint, settings, asked)
    }

    /// The next state of the robot controller, if one has come.
    pub(crate) fn status(&self) -> Option<String> {
        self.words.iter().find_map(Inbox::take)?.message.ok().map(|text| text.data)
    }

    /// Whether the robot's state is published as text.
    pub(crate) fn says_its_state(&self, settings: &LinkSettings) -> bool {
        let topic = format!("rt{}", settings.full(&settings.robot_state));
        !self.words.is_empty() && self.endpoint.count(Peer::Writer, &topic) > 0
    }

    /// Whether the request `disable` has a subscriber.
    pub(crate) fn takes_requests(&self, settings: &LinkSettings) -> bool {
        let topic = format!("rt{}", settings.full(&settings.robot_request));
        self.request.is_some() && self.endpoint.count(Peer::Reader, &topic) > 0
    }

    /// Asks for the drives to go off, where there is a subscriber.
    pub(crate) fn disable(&self) -> Result<(), LinkError> {
        let Some(request) = &self.request else { return Ok(()) };
        let word = Text { data: "disable".to_owned() };
        request.publish(word).map_err(|error| LinkError::middleware("disable", &error.forget_data()))
    }

    /// Other participants that must not be there: a second robot, or another client that commands this one.
    pub(crate) fn interference(&self, settings: &LinkSettings) -> Option<String> {
        let named = |name: &str| settings.full(name);
        // A gripper reports its joints on the same topic: who reports the arm's is told from the messages.
        let mut most = Vec::new();
        if !settings.robot_state.is_empty() {
            most.push((Peer::Writer, format!("rt{}", named(&settings.robot_state)), 1, "say the robot's state on"));
        }
        let motion = format!("rt{}", named(&settings.trajectory));
        match settings.mode {
            Mode::Trajectory => {
                let goals = format!("rq{}/_action/send_goalRequest", named(&settings.action));
                most.push((Peer::Reader, goals, 1, "take goals on"));
                most.push((Peer::Writer, motion, 0, "may send motions on"));
            }
            Mode::Topic => most.push((Peer::Writer, motion, 0, "may send motions on")),
            Mode::Stream => {
                let commands = format!("rt{}", named(&settings.commands));
                most.push((Peer::Writer, commands, 0, "may send set-points on"));
            }
        }
        most.into_iter().find_map(|(peer, topic, expected, does)| {
            let found = self.endpoint.count(peer, &topic);
            let name = topic.trim_start_matches("rt").trim_start_matches("rq");
            (found > expected).then(|| format!("{found} others {does} {name}, expected {expected}"))
        })
    }
}
