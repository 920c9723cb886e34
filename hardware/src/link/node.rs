//! A participant in a ROS domain with one node, whose discovery runs on a thread of its own.

use std::collections::BTreeSet;
use std::net::{IpAddr, Ipv4Addr};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use ros2_client::gid::Gid;
use ros2_client::qos::QosProfile;
use ros2_client::{Context, Message, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, Subscription};
use rustdds::policy;
use rustdds::{DomainParticipant, DomainParticipantBuilder, GUID, RTPSEntity};

use super::{LinkError, LinkSettings, Network, network};

/// Whether the operator has asked for the end.
pub(crate) type Asked = fn() -> bool;

/// Waits for `what`: an error once `settings` have no patience left, or the operator has asked for the end.
pub(crate) struct Patience<'a> {
    began: Instant,
    settings: &'a LinkSettings,
    asked: Asked,
}

impl<'a> Patience<'a> {
    pub(crate) fn new(settings: &'a LinkSettings, asked: Asked) -> Self {
        Self { began: Instant::now(), settings, asked }
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    pub(crate) fn left(&self, what: impl FnOnce() -> String) -> Result<(), LinkError> {
        if (self.asked)() {
            return Err(LinkError::Interrupted);
        }
        if self.elapsed() <= self.settings.patience() {
            return Ok(());
        }
        let (waited_s, domain) = (self.settings.patience_s, self.settings.domain);
        Err(LinkError::Silence { what: what(), waited_s, domain, reason: String::new() })
    }
}

/// A node of a ROS domain.
pub struct Endpoint {
    node: Node,
    participant: DomainParticipant,
    settings: LinkSettings,
    /// The middleware's threads that serve this participant.
    threads: BTreeSet<u32>,
}

/// One at a time, so that the threads and sockets that are new belong to who has just joined.
static JOINING: Mutex<()> = Mutex::new(());

/// Numbers of the middleware's threads in this process; none where the system does not list them.
fn middleware_threads() -> BTreeSet<u32> {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return BTreeSet::new() };
    let named = |path: &std::path::Path| {
        std::fs::read_to_string(path.join("comm")).is_ok_and(|name| name.starts_with("RustDDS"))
    };
    let tasks = tasks.flatten().filter(|task| named(&task.path()));
    tasks.filter_map(|task| task.file_name().to_str()?.parse().ok()).collect()
}

/// Another participant on a DDS topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Peer {
    Writer,
    Reader,
}

/// Joins a domain; the middleware's threads that serve it.
fn context(settings: &LinkSettings) -> Result<(Context, BTreeSet<u32>), LinkError> {
    let _alone = JOINING.lock().unwrap_or_else(PoisonError::into_inner);
    let allowed = network::allowed(&settings.network)?;
    let (threads, sockets) = (middleware_threads(), network::sockets());
    let builder = DomainParticipantBuilder::new(settings.domain);
    let builder = match &settings.network {
        Network::Loopback => builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]),
        Network::Only(addresses) => builder.with_only_networks(addresses.iter().copied()),
        Network::Any => builder,
    };
    let open = || Context::from_domain_participant(builder.build()?);
    let context = open().map_err(|error| LinkError::middleware(format!("ROS domain {}", settings.domain), &error))?;
    if let Some(allowed) = allowed {
        network::keep_out(&allowed, &sockets)?;
    }
    Ok((context, middleware_threads().difference(&threads).copied().collect()))
}

impl Endpoint {
    /// Joins the domain of `settings` as the node `name`.
    ///
    /// # Errors
    /// [`LinkError`] where a setting is impossible or the network refuses.
    pub fn join(settings: &LinkSettings, name: &str) -> Result<Self, LinkError> {
        settings.check()?;
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware(format!("node {name}"), error);
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let named = NodeName::new("/", name).map_err(|error| fault(&error))?;
        let (context, threads) = context(settings)?;
        let participant = context.domain_participant();
        let mut node = context.new_node(named, options).map_err(|error| fault(&error))?;
        let spinner = node.spinner().map_err(|error| fault(&error))?;
        std::thread::Builder::new()
            .name(format!("{name} discovery"))
            // It ends when the node is dropped; what discovery has to say is asked of the node.
            .spawn(move || smol::block_on(spinner.spin()).is_ok())
            .map_err(|error| fault(&error))?;
        Ok(Self { node, participant, settings: settings.clone(), threads })
    }

    /// Whether the middleware's threads of this participant are all there. Its event loop ends where a wait is interrupted
    /// (RustDDS 0.15.1, `dp_event_loop.rs`), as by a process that is stopped and continued: nothing is sent or received
    /// from then on, and no call says so.
    pub(crate) fn is_alive(&self) -> bool {
        self.threads.is_empty() || self.threads.is_subset(&middleware_threads())
    }

    /// The node, for what has no short cut here.
    pub(crate) fn node(&mut self) -> &mut Node {
        &mut self.node
    }

    /// A name as ROS takes it.
    pub(crate) fn name(full: &str) -> Result<Name, LinkError> {
        Name::parse(full).map_err(|error| LinkError::middleware(format!("name \"{full}\""), &error))
    }

    /// Publishes on a topic.
    pub(crate) fn publisher<M: Message>(
        &mut self,
        topic: &str,
        (package, message): (&str, &str),
        qos: &QosProfile,
    ) -> Result<Publisher<M>, LinkError> {
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware(format!("topic {topic}"), error);
        let kind = MessageTypeName::new(package, message);
        let topic = self.node.create_topic(&Self::name(topic)?, kind, qos).map_err(|error| fault(&error))?;
        self.node.create_publisher(&topic, None).map_err(|error| fault(&error))
    }

    /// Listens to a topic.
    pub(crate) fn subscription<M: Message + 'static>(
        &mut self,
        topic: &str,
        (package, message): (&str, &str),
        qos: &QosProfile,
    ) -> Result<Subscription<M>, LinkError> {
        let fault = |error: &dyn std::fmt::Debug| LinkError::middleware(format!("topic {topic}"), error);
        let kind = MessageTypeName::new(package, message);
        let topic = self.node.create_topic(&Self::name(topic)?, kind, qos).map_err(|error| fault(&error))?;
        self.node.create_subscription(&topic, None).map_err(|error| fault(&error))
    }

    /// The domain.
    pub fn domain(&self) -> u16 {
        self.settings.domain
    }

    /// Waits until another participant writes or reads every one of these DDS topics; the error names them by `what`.
    pub(crate) fn wait(&self, what: &str, topics: &[(Peer, String)], asked: Asked) -> Result<(), LinkError> {
        let patience = Patience::new(&self.settings, asked);
        while !self.has(topics) {
            patience.left(|| what.to_owned())?;
            std::thread::sleep(Duration::from_millis(10));
        }
        let mismatch = topics.iter().find_map(|(peer, topic)| self.mismatch(*peer, topic));
        mismatch.map_or(Ok(()), |reason| Err(self.silence(what.to_owned(), Some(reason))))
    }

    /// That nothing came within the patience, and why.
    pub(crate) fn silence(&self, what: String, reason: Option<&str>) -> LinkError {
        let reason = reason.map_or_else(String::new, |reason| format!("; {reason}"));
        LinkError::Silence { what, waited_s: self.settings.patience_s, domain: self.settings.domain, reason }
    }

    /// Whether all of these others have been seen.
    pub(crate) fn has(&self, topics: &[(Peer, String)]) -> bool {
        topics.iter().all(|(peer, topic)| self.count(*peer, topic) > 0)
    }

    /// Whether somebody who sent something is still there.
    pub(crate) fn has_writer(&self, writer: Gid) -> bool {
        let all = self.participant.discovered_writers();
        all.iter().any(|found| Gid::from(found.writer_proxy.remote_writer_guid) == writer)
    }

    /// Why no message of a DDS topic passes between us and the others who write or read it, where every one of them offers
    /// less than our reader asks for, or asks for more than our writer offers.
    fn mismatch(&self, peer: Peer, topic: &str) -> Option<&'static str> {
        let (own, reliable) = (self.participant.guid().prefix, self.settings.reliable);
        let (fits, reason): (Vec<bool>, _) = match peer {
            Peer::Writer => {
                let all = self.participant.discovered_writers();
                let there = all.iter().filter(|found| found.publication_topic_data.topic_name == topic);
                let others = there.filter(|found| found.writer_proxy.remote_writer_guid.prefix != own);
                let offered = others.map(|found| found.publication_topic_data.reliability);
                let fits = offered.map(|offered| !reliable || offered != Some(policy::Reliability::BestEffort));
                let reason =
                    "it is published best-effort, and this side asks for reliable: set reliable = false in [ros2]";
                (fits.collect(), reason)
            }
            Peer::Reader => {
                let all = self.participant.discovered_readers();
                let there = all.iter().filter(|found| found.subscription_topic_data.topic_name() == topic);
                let others = there.filter(|found| found.reader_proxy.remote_reader_guid.prefix != own);
                let asked = others.map(|found| found.subscription_topic_data.qos().durability());
                let fits = asked.map(|asked| asked.is_none_or(|asked| asked == policy::Durability::Volatile));
                (fits.collect(), "its reader asks for transient-local messages, expected volatile")
            }
        };
        (!fits.is_empty() && !fits.contains(&true)).then_some(reason)
    }

    /// How many others write or read a DDS topic.
    pub(crate) fn count(&self, peer: Peer, topic: &str) -> usize {
        let own = self.participant.guid().prefix;
        let found: BTreeSet<GUID> = match peer {
            Peer::Writer => {
                let all = self.participant.discovered_writers();
                let here = all.iter().filter(|found| found.publication_topic_data.topic_name == topic);
                here.map(|found| found.writer_proxy.remote_writer_guid).collect()
            }
            Peer::Reader => {
                let all = self.participant.discovered_readers();
                let here = all.iter().filter(|found| found.subscription_topic_data.topic_name() == topic);
                here.map(|found| found.reader_proxy.remote_reader_guid).collect()
            }
        };
        found.iter().filter(|guid| guid.prefix != own).count()
    }
}

/// Topics that others publish or listen to in the domain of `settings`, discovered within `listen`, in the order of
/// names.
///
/// # Errors
/// [`LinkError`] where the network refuses.
pub fn peers(settings: &LinkSettings, listen: Duration) -> Result<Vec<String>, LinkError> {
    let (context, _) = context(settings)?;
    let participant = context.domain_participant();
    std::thread::sleep(listen);
    let own = participant.guid().prefix;
    let written = participant.discovered_writers();
    let read = participant.discovered_readers();
    let written =
        written.iter().map(|found| (found.writer_proxy.remote_writer_guid, &found.publication_topic_data.topic_name));
    let read =
        read.iter().map(|found| (found.reader_proxy.remote_reader_guid, found.subscription_topic_data.topic_name()));
    let mut topics: Vec<String> = written
        .chain(read)
        .filter(|(guid, _)| guid.prefix != own)
        // ROS 2 puts "rt" in front of a topic, "rq" and "rr" in front of the two halves of a service.
        .filter_map(|(_, name)| name.strip_prefix("rt/").map(|rest| format!("/{rest}")))
        .collect();
    topics.sort_unstable();
    topics.dedup();
    Ok(topics)
}
