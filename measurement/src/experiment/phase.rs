//! The parts of an experiment, in the order in which they are performed.

use std::ops::Range;

/// What the arm is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// At rest at the start pose, until the servo carries the weight.
    Settle,
    /// From rest into the periodic motion.
    RampIn,
    /// Whole periods that are performed and discarded: the transient decays.
    Discard,
    /// Whole periods that count.
    Record,
    /// From the periodic motion to rest.
    RampOut,
}

crate::input::named! { Phase {
    Settle: "settle", RampIn: "ramp-in", Discard: "discard", Record: "record", RampOut: "ramp-out"
} }

/// A phase and the samples that belong to it.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PhaseSpan {
    /// Which phase.
    pub phase: Phase,
    /// Its samples, counted from the first of the experiment.
    pub samples: Range<usize>,
}
