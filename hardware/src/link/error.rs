//! What can go wrong on the link.

use armid_cdr::CdrError;

/// Why the link cannot be used, or cannot be used any longer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum LinkError {
    /// A setting is impossible.
    #[error("ros2.{key} is {found}, expected {expected}")]
    Setting { key: &'static str, found: String, expected: &'static str },
    /// DDS or ROS 2 refuses.
    #[error("{what}: {reason}")]
    Middleware { what: String, reason: String },
    /// A date or a duration that a message cannot hold.
    #[error(transparent)]
    Cdr(#[from] CdrError),
    /// Nothing was received in time.
    #[error("{what}: nothing received within {waited_s} s in ROS domain {domain}{reason}")]
    Silence { what: String, waited_s: f64, domain: u16, reason: String },
    /// The operator asked for the end before anything moved.
    #[error("interrupted while the robot was looked for")]
    Interrupted,
    /// An address that this machine does not have, or networks that this system cannot tell apart.
    #[error("ros2.network: {0}")]
    Network(String),
    /// The names in a joint state are not those of the robot.
    #[error("joint state: {fault}: found {found:?}, expected {expected:?} in any order")]
    Joints { fault: String, found: Vec<String>, expected: Vec<String> },
    /// A list of a joint state has not one value for each name.
    #[error("joint state: {quantity} has {found} values, expected {expected}, one for each name")]
    Length { quantity: &'static str, found: usize, expected: usize },
    /// Joint states come, and their stamps do not advance.
    #[error(
        "{topic}: {messages} messages came, all stamped {stamp_s} s; expected stamps that advance with the robot's clock"
    )]
    Stamps { topic: String, messages: usize, stamp_s: f64 },
    /// The robot's clock runs faster or more slowly than ours, or is stepped.
    #[error("the robot's clock {found}, expected as much within 2 %: see what stamps its joint states")]
    Clock { found: String },
    /// The robot controller does not take the motion.
    #[error("the robot controller refuses the motion: {reason}")]
    Refused { reason: String },
    /// Another client commands the arm, or a second robot answers to its names.
    #[error("interference: {0}")]
    Interference(String),
    /// The robot controller says neither yes nor no to a motion.
    #[error("no answer to the motion within {waited_ms:.0} ms, expected one within {bound_ms:.0} ms")]
    NoAcceptance { waited_ms: f64, bound_ms: f64 },
    /// The robot controller never says how a motion ended.
    #[error("no result {waited_ms:.0} ms after the motion's end, expected one within {bound_ms:.0} ms")]
    NoResult { waited_ms: f64, bound_ms: f64 },
    /// The next piece of a motion came too late: the arm brakes already, or is about to.
    #[error(
        "the next piece of the motion is due {left_ms:.0} ms before the arm brakes, expected at least {bound_ms:.0} ms"
    )]
    LatePiece { left_ms: f64, bound_ms: f64 },
    /// A thread of the middleware is gone.
    #[error("a thread of the middleware has ended: nothing is sent or received any more")]
    Thread,
    /// This program itself failed.
    #[error("armid itself failed: {0}")]
    Panic(String),
    /// The robot controller gave the motion up.
    #[error("the robot controller ended the motion: {reason}")]
    Aborted { reason: String },
}

impl LinkError {
    pub(crate) fn middleware(what: impl Into<String>, reason: &dyn std::fmt::Debug) -> Self {
        Self::Middleware { what: what.into(), reason: format!("{reason:?}") }
    }
}
