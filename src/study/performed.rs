//! What came of an experiment of a study.

use crate::experiment::{ArmError, Ending, Recording};

/// What came of one experiment: the recording and how it ended, or why it did not begin.
pub type Performed = Result<(Recording, Ending), ArmError>;
