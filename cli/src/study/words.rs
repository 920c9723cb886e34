//! Errors of others as errors of the command.

use armid_io::Error;

/// An error in its own words.
pub(crate) fn in_words(error: impl std::fmt::Display) -> Error {
    Error::new(error.to_string())
}
