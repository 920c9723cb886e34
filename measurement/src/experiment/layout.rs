//! Which samples of an experiment belong to which of its phases.

use std::ops::Range;

use super::phase::{Phase, PhaseSpan};

/// Which samples belong to which phase of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// All five phases in order; the first begins at sample 0, each begins where the one before ends.
    pub spans: Vec<PhaseSpan>,
    /// Samples in one period of the motion.
    pub period_samples: usize,
}

impl Layout {
    /// The samples of one phase.
    pub fn span(&self, phase: Phase) -> Range<usize> {
        self.spans.iter().find(|span| span.phase == phase).map_or(0..0, |span| span.samples.clone())
    }

    /// All samples.
    pub fn samples(&self) -> usize {
        self.spans.last().map_or(0, |span| span.samples.end)
    }

    /// The phase of one sample; beyond the last one it is the last phase.
    pub fn phase(&self, sample: usize) -> Phase {
        self.spans.iter().find(|span| span.samples.contains(&sample)).map_or(Phase::RampOut, |span| span.phase)
    }
}
