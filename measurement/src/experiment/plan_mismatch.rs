//! Where a recording is not one of a plan.

use std::ops::Range;

use super::phase::Phase;

/// What a recording and a plan do not have in common.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum PlanMismatchError {
    /// The sampling rate.
    #[error("the recording's rate_hz is {found}, expected the plan's {planned}")]
    Rate { found: f64, planned: f64 },
    /// The number of samples in a period.
    #[error("the recording's samples per period is {found}, expected the plan's {planned}")]
    PeriodSamples { found: usize, planned: usize },
    /// The motion.
    #[error("the recording's trajectory is another motion, expected the plan's motion")]
    Trajectory,
    /// The number of recorded periods.
    #[error("the recording's number of recorded periods is {found}, expected the plan's {planned}")]
    Periods { found: usize, planned: usize },
    /// The samples of a phase.
    #[error(
        "the recording's {} is samples {} to {}, expected the plan's samples {} to {}",
        phase.name(), found.start, found.end, planned.start, planned.end
    )]
    Span { phase: Phase, found: Range<usize>, planned: Range<usize> },
}
