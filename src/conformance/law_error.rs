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
    pub expected: String,
}

impl LawError {
    /// Breaks unless `value` is at most `most`; NaN breaks.
    pub(super) fn unless_at_most(law: &'static str, value: f64, most: f64) -> Result<(), Self> {
        if value <= most {
            Ok(())
        } else {
            Err(Self { law, found: format!("{value:.3e}"), expected: format!("at most {most:.3e}") })
        }
    }

    /// Breaks by an error where something is expected.
    pub(super) fn failed(law: &'static str, fault: &impl fmt::Display, expected: impl Into<String>) -> Self {
        Self { law, found: fault.to_string(), expected: expected.into() }
    }

    /// Breaks unless `holds`.
    pub(super) fn unless(
        law: &'static str,
        holds: bool,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { law, found: found.into(), expected: expected.into() }) }
    }
}
