//! The looks at a study that ends where an interval is narrow enough.

use std::path::Path;

use armid::study::Look;
use armid_io::Error;
use armid_io::output::{pretty, write_text};

/// The looks at a study, and how it ended.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Looks {
    /// What was wanted, as it was asked for.
    pub until: String,
    /// Every look, the last being the end.
    pub looks: Vec<Look>,
    /// `narrow-enough`, or `all-starts` where all of the plan's starts were not enough.
    pub termination: &'static str,
}

impl Looks {
    /// What the files of a study call it.
    const NAME: &'static str = "looks.json";

    /// Is the interval narrow enough?
    pub fn is_met(&self) -> bool {
        self.termination == "narrow-enough"
    }

    /// Starts of each family at the end.
    pub fn starts(&self) -> usize {
        self.looks.last().map_or(0, |look| look.starts)
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), Error> {
        let value = serde_json::to_value(self).map_err(|error| Error::new(format!("the looks: {error}")))?;
        write_text(&folder.join(Self::NAME), &pretty(&value))
    }
}
