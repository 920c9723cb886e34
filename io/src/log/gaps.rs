//! Samples that are missing in a recording of a real arm.

use serde::Deserialize;
use serde_json::{Value, json};

use super::joint_log::Log;
use crate::error::Error;

/// What a link noted of its stamps, as far as it counts here.
#[derive(Deserialize)]
struct Stamps {
    /// Samples that lie on a line across a gap.
    missing: Vec<usize>,
}

/// What is missing in a recording of a real arm, and what that means for its average.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    /// Samples that lie on a line across a gap.
    missing: usize,
    /// The recorded periods that hold one, from one.
    periods: Vec<usize>,
    /// Whether those periods are left out; not where they are all there are.
    left_out: bool,
}

impl Gaps {
    /// Leaves out the periods of a recording that hold a missing sample, where others are left.
    pub(super) fn leave_out(log: &mut Log) -> Result<Option<Self>, Error> {
        let (Some(text), Some(recording)) = (log.notes.get("stamps"), &mut log.recording) else { return Ok(None) };
        let stamps: Stamps = serde_json::from_str(text)
            .map_err(|error| Error::new(format!("{}: metadata \"stamps\": {error}", log.name)))?;
        if stamps.missing.is_empty() {
            return Ok(None);
        }
        let mut less = recording.clone();
        let periods: Vec<usize> = less.leave_out(&stamps.missing).into_iter().map(|period| period + 1).collect();
        let left_out = less.periods() > 0 && !periods.is_empty();
        if left_out {
            *recording = less;
        }
        Ok(Some(Self { missing: stamps.missing.len(), periods, left_out }))
    }

    /// One sentence, with its newline.
    pub fn text(&self) -> String {
        let list: Vec<String> = self.periods.iter().map(usize::to_string).collect();
        let (missing, list) = (self.missing, list.join(", "));
        match (self.periods.is_empty(), self.left_out) {
            (true, _) => format!("{missing} samples are missing, none of them in a period that counts\n"),
            (_, true) => format!("{missing} samples are missing; left out: period {list}\n"),
            _ => format!("{missing} samples are missing in every period; they lie on lines across the gaps\n"),
        }
    }

    /// The gaps as JSON.
    pub fn json(&self) -> Value {
        json!({ "missing_samples": self.missing, "periods": self.periods, "left_out": self.left_out })
    }
}
