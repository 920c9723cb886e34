//! What a law suite reports.

use std::fmt;

/// A law that an implementation breaks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{law}: found {found}, expected {expected}")]
pub struct LawError {
    /// The law, in words.
    pub law: &'static str,
    /// What was found.
    pub found: String,
    /// What the law asks for.
    pub expected: Requirement,
}

/// What a law asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Requirement {
    /// A number not above this one.
    AtMost(f64),
    /// What the law says in words.
    Words(&'static str),
    /// A value that follows from the case at hand, written out.
    Value(String),
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtMost(most) => write!(f, "at most {most:.3e}"),
            Self::Words(words) => f.write_str(words),
            Self::Value(value) => f.write_str(value),
        }
    }
}

impl From<&'static str> for Requirement {
    fn from(words: &'static str) -> Self {
        Self::Words(words)
    }
}

impl From<String> for Requirement {
    fn from(value: String) -> Self {
        Self::Value(value)
    }
}

impl LawError {
    /// Breaks unless `value` is at most `most`; NaN breaks.
    pub(super) fn unless_at_most(law: &'static str, value: f64, most: f64) -> Result<(), Self> {
        if value <= most {
            Ok(())
        } else {
            Err(Self { law, found: format!("{value:.3e}"), expected: Requirement::AtMost(most) })
        }
    }

    /// Breaks by an error where something is expected.
    pub(super) fn failed(law: &'static str, fault: &impl fmt::Display, expected: impl Into<Requirement>) -> Self {
        Self { law, found: fault.to_string(), expected: expected.into() }
    }

    /// Breaks unless `holds`.
    pub(super) fn unless(
        law: &'static str,
        holds: bool,
        found: impl Into<String>,
        expected: impl Into<Requirement>,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { law, found: found.into(), expected: expected.into() }) }
    }
}
