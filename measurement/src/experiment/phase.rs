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

impl Phase {
    /// All, in order.
    pub const ALL: [Self; 5] = [Self::Settle, Self::RampIn, Self::Discard, Self::Record, Self::RampOut];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Settle => "settle",
            Self::RampIn => "ramp-in",
            Self::Discard => "discard",
            Self::Record => "record",
            Self::RampOut => "ramp-out",
        }
    }

    /// The phase with this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|phase| phase.name() == name)
    }
}

/// A phase and the samples that belong to it.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PhaseSpan {
    /// Which phase.
    pub phase: Phase,
    /// Its samples, counted from the first of the experiment.
    pub samples: Range<usize>,
}
