//! What can go wrong on the link.

use armid_cdr::CdrError;

/// Why the link cannot be used, or cannot be used any longer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// A setting is impossible.
    #[error("ros2.{key} is {found}, expected {expected}")]
    Setting {
        /// Its key.
        key: &'static str,
        /// What was found.
        found: String,
        /// What is possible.
        expected: &'static str,
    },
    /// DDS or ROS 2 refuses.
    #[error("{what}: {reason}")]
    Middleware {
        /// What was asked for.
        what: String,
        /// What it says.
        reason: String,
    },
    /// A date or a duration that a message cannot hold.
    #[error(transparent)]
    Cdr(#[from] CdrError),
    /// Nothing was received in time.
    #[error("{what}: nothing received within {waited_s} s in ROS domain {domain}{reason}")]
    Silence {
        /// What was waited for.
        what: String,
        /// How long, s.
        waited_s: f64,
        /// In which domain.
        domain: u16,
        /// Why, after a semicolon; empty where that is not known.
        reason: String,
    },
    /// The operator asked for the end before anything moved.
    #[error("interrupted while the robot was looked for")]
    Interrupted,
    /// An address that this machine does not have, or networks that this system cannot tell apart.
    #[error("ros2.network: {0}")]
    Network(String),
    /// The names in a joint state are not those of the robot.
    #[error("joint state: {fault}: found {found:?}, expected {expected:?} in any order")]
    Joints {
        /// What is wrong.
        fault: String,
        /// The names in the message.
        found: Vec<String>,
        /// The names of the robot.
        expected: Vec<String>,
    },
    /// A list of a joint state has not one value for each name.
    #[error("joint state: {quantity} has {found} values, expected {expected}, one for each name")]
    Length {
        /// Which list.
        quantity: &'static str,
        /// Its length.
        found: usize,
        /// Number of names.
        expected: usize,
    },
    /// Joint states come, and their stamps do not advance.
    #[error(
        "{topic}: {messages} messages came, all stamped {stamp_s} s; expected stamps that advance with the robot's clock"
    )]
    Stamps {
        /// On which topic.
        topic: String,
        /// How many.
        messages: usize,
        /// Their stamp, s.
        stamp_s: f64,
    },
    /// The robot's clock runs faster or more slowly than ours, or is stepped.
    #[error("the robot's clock {found}, expected as much within 2 %: see what stamps its joint states")]
    Clock {
        /// How far it has come while ours has come how far.
        found: String,
    },
    /// The robot controller does not take the motion.
    #[error("the robot controller refuses the motion: {reason}")]
    Refused {
        /// What it says, if anything.
        reason: String,
    },
    /// Another client commands the arm, or a second robot answers to its names.
    #[error("interference: {0}")]
    Interference(String),
    /// The robot controller says neither yes nor no to a motion.
    #[error("no answer to the motion within {waited_ms:.0} ms, expected one within {bound_ms:.0} ms")]
    NoAcceptance {
        /// How long, ms.
        waited_ms: f64,
        /// How long it may take, ms.
        bound_ms: f64,
    },
    /// The robot controller never says how a motion ended.
    #[error("no result {waited_ms:.0} ms after the motion's end, expected one within {bound_ms:.0} ms")]
    NoResult {
        /// How long, ms.
        waited_ms: f64,
        /// How long it may take, ms.
        bound_ms: f64,
    },
    /// The next piece of a motion came too late: the arm brakes already, or is about to.
    #[error(
        "the next piece of the motion is due {left_ms:.0} ms before the arm brakes, expected at least {bound_ms:.0} ms"
    )]
    LatePiece {
        /// What is left, ms.
        left_ms: f64,
        /// What must be left, ms.
        bound_ms: f64,
    },
    /// A thread of the middleware is gone.
    #[error("a thread of the middleware has ended: nothing is sent or received any more")]
    Thread,
    /// This program itself failed.
    #[error("armid itself failed: {0}")]
    Panic(String),
    /// The robot controller gave the motion up.
    #[error("the robot controller ended the motion: {reason}")]
    Aborted {
        /// What it says.
        reason: String,
    },
}

impl LinkError {
    pub(crate) fn middleware(what: impl Into<String>, reason: &dyn std::fmt::Debug) -> Self {
        Self::Middleware { what: what.into(), reason: format!("{reason:?}") }
    }
}
