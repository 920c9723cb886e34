//! Sinks that end as a file.

use std::collections::BTreeMap;
use std::path::PathBuf;

use armid::experiment::{Ending, Sink};

use crate::error::Error;

/// A sink whose samples end in a file.
pub trait FileSink: Sink + Send {
    /// Completes the file. It takes its name where the experiment was completed, and ends in `.part` otherwise.
    /// `remarks` are what is known only now and goes into the file beside its ending. Returns where it is.
    ///
    /// # Errors
    /// [`Error`] where the arm never began, or a file could not be written, now or before.
    fn finish(self: Box<Self>, ending: &Ending, remarks: BTreeMap<String, String>) -> Result<PathBuf, Error>;
}
