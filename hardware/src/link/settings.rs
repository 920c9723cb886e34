//! How to reach a robot: the table `[ros2]` of an experiment.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::time::Duration;

use ros2_client::ServiceMapping;
use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use serde::{Deserialize, Serialize};

use super::LinkError;

/// How a motion goes out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Handed over as goals of the action `FollowJointTrajectory`: acknowledged, watched, cancelled.
    #[default]
    Trajectory,
    /// Handed over as `JointTrajectory` on a topic: a point at the present position ends it, nothing is acknowledged.
    Topic,
    /// Set-point by set-point, one for each joint state that arrives.
    Stream,
}

armid::input::named! { Mode { Trajectory: "trajectory", Topic: "topic", Stream: "stream" } }

/// Which networks the link may use.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Network {
    /// This machine alone.
    #[default]
    Loopback,
    /// Every network of this machine.
    Any,
    /// The networks in which this machine has these addresses.
    Only(Vec<IpAddr>),
}

/// How services, and so actions, are laid onto DDS topics; it differs between ROS 2's middlewares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ServiceMappingName {
    /// DDS-RPC "enhanced": Fast DDS, Connext.
    #[default]
    Enhanced,
    /// DDS-RPC "basic".
    Basic,
    /// Cyclone DDS's own.
    Cyclone,
}

impl From<ServiceMappingName> for ServiceMapping {
    fn from(name: ServiceMappingName) -> Self {
        match name {
            ServiceMappingName::Enhanced => Self::Enhanced,
            ServiceMappingName::Basic => Self::Basic,
            ServiceMappingName::Cyclone => Self::Cyclone,
        }
    }
}

/// Everything about the link; every key has a default.
///
/// ```
/// use armid_hardware::link::{LinkSettings, Mode, Network};
/// let settings = LinkSettings::default();
/// assert_eq!((settings.domain, settings.mode, &settings.network), (0, Mode::Trajectory, &Network::Loopback));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LinkSettings {
    /// ROS domain, 0 to 232.
    pub domain: u16,
    /// Which networks.
    pub network: Network,
    /// Namespace in front of every name that does not begin with `/`.
    pub namespace: String,
    /// Topic of the joint states.
    pub joint_states: String,
    /// How a motion goes out.
    pub mode: Mode,
    /// Action of `mode = "trajectory"`.
    pub action: String,
    /// Topic of `mode = "topic"`.
    pub trajectory: String,
    /// Topic of `mode = "stream"`.
    pub commands: String,
    /// Topic on which the robot controller reports its state as text; empty where it does not.
    pub robot_state: String,
    /// States in which the arm may move: homed, drives on, no emergency stop. In any other a run is refused, or trips.
    pub ready_states: Vec<String>,
    /// Prefixes of the states in which the drives are off.
    pub off_states: Vec<String>,
    /// Topic on which it takes the request `disable`; empty where it does not.
    pub robot_request: String,
    /// How services are laid onto topics.
    pub service_mapping: ServiceMappingName,
    /// Whether joint states are sent again when they are lost.
    pub reliable: bool,
    /// How many messages are kept on each side.
    pub depth: usize,
    /// The robot's names of joints that it calls otherwise than its robot file: file's name → robot's name.
    pub joint_names: BTreeMap<String, String>,
    /// Joints that the robot reports and that are not part of the arm, such as a gripper.
    pub other_joints: Vec<String>,
    /// How far ahead of the last joint state a motion begins, s.
    pub lead_s: f64,
    /// Distance of two points of a trajectory that is handed over, s.
    pub point_spacing_s: f64,
    /// After how much time a motion that was handed over ends at rest by itself where nothing follows, s: it goes out in
    /// pieces that end with a braking tail. 0 hands it over whole, for a robot that replaces no motion under way.
    pub horizon_s: f64,
    /// How long to wait for the robot, s.
    pub patience_s: f64,
}

impl Default for LinkSettings {
    fn default() -> Self {
        Self {
            domain: 0,
            network: Network::Loopback,
            namespace: "/".to_owned(),
            joint_states: "joint_states".to_owned(),
            mode: Mode::Trajectory,
            action: "joint_trajectory_controller/follow_joint_trajectory".to_owned(),
            trajectory: "joint_trajectory_controller/joint_trajectory".to_owned(),
            commands: "forward_position_controller/commands".to_owned(),
            robot_state: "robot_state".to_owned(),
            ready_states: ["hold", "follow", "stream"].map(|doing| format!("enabled homed {doing}")).to_vec(),
            off_states: ["disabled", "estop", "fault"].map(str::to_owned).to_vec(),
            robot_request: "robot_request".to_owned(),
            service_mapping: ServiceMappingName::Enhanced,
            reliable: true,
            depth: 100,
            joint_names: BTreeMap::new(),
            other_joints: Vec::new(),
            lead_s: 0.5,
            point_spacing_s: 0.05,
            horizon_s: 0.5,
            patience_s: 10.0,
        }
    }
}

impl LinkSettings {
    /// Checks every value.
    ///
    /// # Errors
    /// [`LinkError::Setting`] for the first that is impossible.
    pub fn check(&self) -> Result<(), LinkError> {
        let wrong =
            |key: &'static str, found: String, expected: &'static str| Err(LinkError::Setting { key, found, expected });
        if self.domain > 232 {
            return wrong("domain", self.domain.to_string(), "0 to 232");
        }
        for (key, found, low, high, expected) in [
            ("lead_s", self.lead_s, 0.05, 60.0, "0.05 to 60 s"),
            ("point_spacing_s", self.point_spacing_s, 0.001, 1.0, "0.001 to 1 s"),
            ("patience_s", self.patience_s, 0.1, 600.0, "0.1 to 600 s"),
        ] {
            if !(low..=high).contains(&found) {
                return wrong(key, found.to_string(), expected);
            }
        }
        if self.horizon_s != 0.0 && !(0.4..=10.0).contains(&self.horizon_s) {
            return wrong(
                "horizon_s",
                self.horizon_s.to_string(),
                "0.4 to 10 s, or 0 for a motion that goes out whole",
            );
        }
        if self.horizon_s > 0.0 && self.point_spacing_s > 0.1 {
            return wrong("point_spacing_s", self.point_spacing_s.to_string(), "at most 0.1 s in pieces of a motion");
        }
        if !(1..=10_000).contains(&self.depth) {
            return wrong("depth", self.depth.to_string(), "1 to 10000 messages");
        }
        if let Network::Only(addresses) = &self.network
            && addresses.is_empty()
        {
            return wrong("network", "no address".to_owned(), "loopback, any, or at least one address of this machine");
        }
        Ok(())
    }

    /// Whether the arm may move in this state of its controller.
    pub fn is_ready(&self, state: &str) -> bool {
        self.ready_states.iter().any(|ready| ready == state.trim())
    }

    /// The full name of a topic or action.
    pub fn full(&self, name: &str) -> String {
        if name.starts_with('/') {
            return name.to_owned();
        }
        format!("/{}/{name}", self.namespace.trim_matches('/')).replace("//", "/")
    }

    /// How long to wait for the robot.
    pub fn patience(&self) -> Duration {
        Duration::from_secs_f64(self.patience_s.clamp(0.0, 3600.0))
    }

    /// Quality of service of the joint states.
    pub(crate) fn state_qos(&self) -> QosProfile {
        let reliability =
            if self.reliable { Reliability::Reliable { when_full: WhenFull::Fail } } else { Reliability::BestEffort };
        self.qos(reliability)
    }

    /// Quality of service of everything that must arrive.
    pub(crate) fn command_qos(&self) -> QosProfile {
        self.qos(Reliability::Reliable { when_full: WhenFull::DEFAULT })
    }

    /// Quality of service of what is of no use once something newer is there.
    pub(crate) fn newest_qos(&self) -> QosProfile {
        self.command_qos().history(History::KeepLast { depth: 1 })
    }

    /// Quality of service of reports to any subscriber. One that has ended and does not acknowledge must not hold up the sender.
    pub(crate) fn report_qos(&self) -> QosProfile {
        self.qos(Reliability::Reliable { when_full: WhenFull::Fail })
    }

    /// Quality of service of a monitor: it acknowledges nothing, so that no publisher ever waits for it.
    pub(crate) fn monitor_qos(&self) -> QosProfile {
        self.qos(Reliability::BestEffort)
    }

    fn qos(&self, reliability: Reliability) -> QosProfile {
        QosProfile::publisher_default()
            .reliability(reliability)
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: self.depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_put_into_the_namespace() {
        let named = |namespace: &str| LinkSettings { namespace: namespace.to_owned(), ..Default::default() };
        for (namespace, name, full) in [
            ("/", "joint_states", "/joint_states"),
            ("", "joint_states", "/joint_states"),
            ("/lab/arm/", "a/b", "/lab/arm/a/b"),
            ("lab", "/joint_states", "/joint_states"),
        ] {
            assert_eq!(named(namespace).full(name), full);
        }
    }

    #[test]
    fn impossible_settings_are_named() {
        assert_eq!(LinkSettings::default().check(), Ok(()));
        for (settings, key) in [
            (LinkSettings { domain: 233, ..Default::default() }, "domain"),
            (LinkSettings { lead_s: f64::NAN, ..Default::default() }, "lead_s"),
            (LinkSettings { point_spacing_s: 0.0, ..Default::default() }, "point_spacing_s"),
            (LinkSettings { depth: 0, ..Default::default() }, "depth"),
            (LinkSettings { network: Network::Only(Vec::new()), ..Default::default() }, "network"),
        ] {
            let message = settings.check().unwrap_err().to_string();
            assert!(message.contains(key), "{message}");
        }
    }
}
