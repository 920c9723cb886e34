//! What a journal keeps: designs and runs of a study, as they are finished.

use armid::study::{Outcome, StoredWorkError, StudyDesign, StudySetup};

/// A finished piece of a study.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Piece {
    /// A design, with the Cramér–Rao standard deviations at its exact motion, none where there is no bound.
    Design {
        /// Its place in the list of designs.
        index: usize,
        /// The design.
        design: Box<StudyDesign>,
        /// Standard deviations of the base parameters.
        bound: Vec<Option<f64>>,
        /// Wall time, s.
        seconds: f64,
    },
    /// A run.
    Run {
        /// What came of it.
        outcome: Box<Outcome>,
        /// Wall time, s.
        seconds: f64,
    },
}

impl Piece {
    /// Checks that a piece is one of a study.
    ///
    /// # Errors
    /// [`StoredWorkError`] with what was found and what would fit.
    pub fn check(&self, setup: &StudySetup) -> Result<(), StoredWorkError> {
        match self {
            Self::Design { index, design, bound, .. } => setup.check_design(*index, design, bound.len()),
            Self::Run { outcome, .. } => setup.check_outcome(outcome),
        }
    }
}
