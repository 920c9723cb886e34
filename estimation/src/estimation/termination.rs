//! How an iteration ended.

use std::fmt;

use crate::number::significant;

/// How an iteration came to its result; the last iterate is the result in every case.
///
/// ```
/// # use armid_estimation as armid;
/// use armid::estimation::Termination;
/// assert!(Termination::Direct.was_successful());
/// assert!(!Termination::IterationLimit { iterations: 50, last_step: 0.1 }.was_successful());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Termination {
    /// In closed form, without iterating.
    Direct,
    /// The iteration came to rest.
    Converged {
        /// Iterations.
        iterations: usize,
        /// Length of the last step, relative to the iterate.
        last_step: f64,
    },
    /// The iteration ended at an optimum of a convex problem, with a bound of what is left.
    Optimal {
        /// Iterations.
        iterations: usize,
        /// No other set that was asked for has an objective that is lower by more than this part of it.
        gap: f64,
    },
    /// The iteration was still moving when it was stopped.
    IterationLimit {
        /// Iterations.
        iterations: usize,
        /// Length of the last step, relative to the iterate.
        last_step: f64,
    },
    /// An observer ended the iteration.
    Interrupted {
        /// Iterations before.
        iterations: usize,
    },
    /// No step lowered the objective any more, short of the minimum.
    Stalled {
        /// Iterations.
        iterations: usize,
        /// Length of the last step, relative to the iterate.
        last_step: f64,
    },
    /// No step towards the minimum leads to an arm that can be simulated: its mass matrix is not positive definite, or its
    /// motion runs away.
    Unsimulable {
        /// Iterations before.
        iterations: usize,
    },
    /// The equations of a step had no solution.
    Singular {
        /// Iterations before.
        iterations: usize,
    },
}

impl Termination {
    /// Whether the result is what was sought.
    pub const fn was_successful(self) -> bool {
        matches!(self, Self::Direct | Self::Converged { .. } | Self::Optimal { .. })
    }

    /// That of a search whose last step ended so: the step's, where it failed.
    #[must_use]
    pub(super) const fn with_last_step(self, last: Self) -> Self {
        if last.was_successful() { self } else { last }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Direct => write!(f, "solved in closed form"),
            Self::Converged { iterations, .. } => write!(f, "converged after {iterations} iterations"),
            Self::Optimal { iterations, gap } => {
                write!(f, "optimal after {iterations} iterations, to {gap:.0e} of the objective")
            }
            Self::IterationLimit { iterations, last_step } | Self::Stalled { iterations, last_step } => {
                let how = if matches!(self, Self::Stalled { .. }) { "stalled" } else { "stopped" };
                let last = significant(*last_step, 2);
                write!(f, "{how} after {iterations} iterations, the last step was {last} of the iterate")
            }
            Self::Interrupted { iterations } => write!(f, "interrupted after {iterations} iterations"),
            Self::Unsimulable { iterations } => write!(
                f,
                "stopped after {iterations} iterations: the arm of the next step cannot be simulated, its mass matrix is not \
                 positive definite or its motion runs away"
            ),
            Self::Singular { iterations } => {
                write!(f, "stopped after {iterations} iterations: the equations of the next step have no solution")
            }
        }
    }
}
