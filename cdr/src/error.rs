//! Why a message cannot be encoded, or bytes cannot be decoded.

/// Why a message cannot be encoded, or bytes cannot be decoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum CdrError {
    /// The bytes end too early.
    #[error("byte {at}: {needed} more bytes are needed for {what}, {left} are left")]
    Short { what: &'static str, at: usize, needed: usize, left: usize },
    /// The four bytes in front name another encoding.
    #[error("encapsulation is {found:#06x}, expected 0x0000 or 0x0001 (plain CDR)")]
    Encapsulation { found: u16 },
    /// A string is not valid UTF-8.
    #[error("{what} is not UTF-8 text")]
    Text { what: &'static str },
    /// The byte of a Boolean is neither 0 nor 1.
    #[error("{what} is {found}, expected 0 or 1")]
    Bool { what: &'static str, found: u8 },
    /// A value that no ROS 2 message holds.
    #[error("{what} is {kind}, expected numbers, texts, lists and structures of them")]
    Unsupported { what: &'static str, kind: &'static str },
    /// The type of the message refuses a value.
    #[error("{reason}")]
    Value { reason: String },
    /// A time that `builtin_interfaces/msg/Time` cannot hold: its seconds have 32 bits and a sign.
    #[error("time is {seconds} s after the clock's zero, expected -2147483648 to 2147483647 (for dates: up to 2038)")]
    Time { seconds: i64 },
    /// A sequence or a string is longer than its 32-bit length can say.
    #[error("{what} has {length} entries, expected at most 4294967295")]
    Long { what: &'static str, length: usize },
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
