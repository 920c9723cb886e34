//! Why a name is not that of columns that can be estimated.

/// Why a name is not that of columns that can be estimated from motion and torque.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ColumnsError {
    /// No columns have this name.
    #[error("\"{found}\" is not rigid, or rigid and any of these joined by +: {}", words.join(", "))]
    Unknown { found: String, words: Vec<&'static str> },
    /// A term's law depends on the links' parameters, which are not given.
    #[error(
        "\"{name}\", {meaning}, multiplies the torque that the links take, expected parameters of the links by which it is found"
    )]
    Load { name: &'static str, meaning: &'static str },
    /// A term's law depends on what no recording has.
    #[error(
        "\"{name}\", {meaning}, multiplies the temperature of the gear, which no recording has; expected terms of the motion \
         alone: {}", words.join(", ")
    )]
    Warmth { name: &'static str, meaning: &'static str, words: Vec<&'static str> },
}
