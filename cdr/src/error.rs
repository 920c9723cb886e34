//! Why a message cannot be encoded, or bytes cannot be decoded.

/// Why a message cannot be encoded, or bytes cannot be decoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The bytes end too early.
    #[error("byte {at}: {needed} more bytes are needed for {what}, {left} are left")]
    Short {
        /// What was to be read.
        what: &'static str,
        /// Where, bytes from the beginning.
        at: usize,
        /// Bytes that it takes.
        needed: usize,
        /// Bytes that are there.
        left: usize,
    },
    /// The four bytes in front name another encoding.
    #[error("encapsulation is {found:#06x}, expected 0x0000 or 0x0001 (plain CDR)")]
    Encapsulation {
        /// The first two bytes.
        found: u16,
    },
    /// A string is not valid UTF-8.
    #[error("{what} is not UTF-8 text")]
    Text {
        /// Which one.
        what: &'static str,
    },
    /// The byte of a Boolean is neither 0 nor 1.
    #[error("{what} is {found}, expected 0 or 1")]
    Bool {
        /// Which one.
        what: &'static str,
        /// The byte.
        found: u8,
    },
    /// A value that no ROS 2 message holds.
    #[error("{what} is {kind}, expected numbers, texts, lists and structures of them")]
    Unsupported {
        /// Which one.
        what: &'static str,
        /// What it is.
        kind: &'static str,
    },
    /// The type of the message refuses a value.
    #[error("{reason}")]
    Value {
        /// What it says.
        reason: String,
    },
    /// A time that `builtin_interfaces/msg/Time` cannot hold: its seconds have 32 bits and a sign.
    #[error("time is {seconds} s after the clock's zero, expected -2147483648 to 2147483647 (for dates: up to 2038)")]
    Time {
        /// Whole seconds.
        seconds: i64,
    },
    /// A sequence or a string is longer than its 32-bit length can say.
    #[error("{what} has {length} entries, expected at most 4294967295")]
    Long {
        /// Which one.
        what: &'static str,
        /// How many there are.
        length: usize,
    },
}

impl serde::ser::Error for CdrError {
    fn custom<T: std::fmt::Display>(reason: T) -> Self {
        Self::Value { reason: reason.to_string() }
    }
}

impl serde::de::Error for CdrError {
    fn custom<T: std::fmt::Display>(reason: T) -> Self {
        Self::Value { reason: reason.to_string() }
    }
}
