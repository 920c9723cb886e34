//! What was found in a log.

use armid::signal::Samples;
use serde::Serialize;

use super::gaps::Gaps;
use super::joint_log::Log;
use super::origin::Origin;

/// What was found in a log, and how much of it is used.
#[derive(Clone, Debug, Serialize)]
pub struct LogReport {
    /// What it is called.
    pub name: String,
    /// Whether its end is there.
    pub complete: bool,
    /// Periods that were averaged; 1 where it has none.
    pub periods: usize,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Time that is used, s.
    pub used_s: f64,
    /// Time that is held out, s.
    pub held_out_s: f64,
    /// Blocks of samples, each of which could be an equation of every joint.
    pub blocks: usize,
    /// Those that are one, for each joint.
    pub equations: Vec<usize>,
    /// What was missing in a recording of armid's own.
    #[serde(skip)]
    pub gaps: Option<Gaps>,
    /// Where it came from, and what was found in it.
    #[serde(flatten)]
    pub origin: Origin,
}

impl LogReport {
    pub(super) fn new(log: &Log, gaps: Option<Gaps>, used: &Samples, held_out: Option<&Samples>) -> Self {
        let n = used.dof();
        let time = |samples: &Samples| (samples.len() * samples.periods) as f64 / samples.rate_hz;
        Self {
            name: log.name.clone(),
            complete: log.complete,
            periods: used.periods,
            rate_hz: log.rate_hz,
            used_s: time(used),
            held_out_s: held_out.map_or(0.0, time),
            blocks: used.blocks(),
            equations: (0..n).map(|i| used.used.iter().skip(i).step_by(n).filter(|used| **used).count()).collect(),
            gaps,
            origin: log.origin.clone(),
        }
    }
}
