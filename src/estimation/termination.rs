//! How an estimator ended.

/// How an estimator came to its result; the last iterate is the estimate in every case.
///
/// ```
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
    /// The iteration was still moving when it was stopped.
    IterationLimit {
        /// Iterations.
        iterations: usize,
        /// Length of the last step, relative to the iterate.
        last_step: f64,
    },
}

impl Termination {
    /// Whether the result is what the estimator was after.
    #[must_use]
    pub const fn was_successful(self) -> bool {
        !matches!(self, Self::IterationLimit { .. })
    }
}
