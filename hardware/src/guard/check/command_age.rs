//! Set-points that would be sent too late.

use super::Check;
use crate::guard::Trip;

/// Trips where a set-point is older than the limit when it is about to be sent. The robot controller has the same limit
/// from its side: it holds where none comes.
pub(super) struct CommandAge {
    line_s: f64,
    used: f64,
}

impl CommandAge {
    pub(super) fn new(line_s: f64) -> Self {
        Self { line_s, used: 0.0 }
    }
}

impl Check for CommandAge {
    fn trip(&self) -> Trip {
        Trip::CommandAge
    }

    fn command(&mut self, _: &[f64], age_s: f64) -> Option<String> {
        self.used = self.used.max(age_s / self.line_s);
        let (found, line) = (1e3 * age_s, 1e3 * self.line_s);
        (age_s > self.line_s).then(|| format!("a set-point is {found:.1} ms late, expected at most {line:.1} ms"))
    }

    fn take_used(&mut self) -> f64 {
        std::mem::take(&mut self.used)
    }
}
