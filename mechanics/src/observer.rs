//! Who watches long work, and may end it?
//!
//! Designs, estimators that iterate, simulations and studies report their [`Progress`] to an [`Observer`], whose answer says
//! whether they go on. Work that was asked to end returns what it has: the last iterate, or the runs that are finished. What an
//! observer answers decides when work ends, never what a finished piece of it is.

use std::fmt;
use std::ops::ControlFlow;

/// A kind of work that is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Work {
    /// Designs of a study.
    Designs,
    /// Runs of a study.
    Runs,
    /// Starts of a design.
    Starts,
    /// Evaluations of a criterion within one start.
    Evaluations,
    /// Steps of an iteration.
    Steps,
    /// Samples of a simulated experiment.
    Samples,
}

/// How far a piece of work is.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::observer::{Progress, Work};
/// assert!(Progress { work: Work::Runs, done: 8, total: 8 }.is_complete());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Progress {
    /// What is counted.
    pub work: Work,
    /// How many are finished.
    pub done: usize,
    /// How many there are, or at most.
    pub total: usize,
}

impl Progress {
    /// Is nothing left?
    pub const fn is_complete(&self) -> bool {
        self.done >= self.total
    }
}

/// Watches work on any of its threads. A function of the progress is one.
///
/// ```
/// # use armid_mechanics as armid;
/// use std::ops::ControlFlow;
/// use armid::observer::{Observer, Progress, Work};
/// let at_most_ten = |progress: Progress| {
///     if progress.done < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
/// };
/// assert!(at_most_ten.observe(Progress { work: Work::Steps, done: 10, total: 50 }).is_break());
/// ```
pub trait Observer: Sync {
    /// Receives how far the work is, and answers whether it goes on. Called often, and on several threads.
    fn observe(&self, progress: Progress) -> ControlFlow<()>;

    /// Receives a sentence for the person who waits.
    fn note(&self, _sentence: &str) {}
}

impl<F: Fn(Progress) -> ControlFlow<()> + Sync> Observer for F {
    fn observe(&self, progress: Progress) -> ControlFlow<()> {
        self(progress)
    }
}

impl fmt::Debug for dyn Observer + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Observer")
    }
}

/// Nobody watches: the work goes on to its own end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn observe(&self, _: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
