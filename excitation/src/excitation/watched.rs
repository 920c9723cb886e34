//! A design problem, and who watches the search for its designs.

use super::problem::DesignProblem;
use crate::observer::{Observer, Progress, Unobserved, Work};

/// A design problem, and who watches the search. A reference to a problem is one that nobody watches.
#[derive(Clone, Copy)]
pub struct WatchedProblem<'a> {
    pub(super) problem: &'a DesignProblem,
    observer: &'a dyn Observer,
}

impl DesignProblem {
    /// This problem, for a search that reports to an observer and ends when it says so, with the best iterate so far.
    pub const fn watched_by<'a>(&'a self, observer: &'a dyn Observer) -> WatchedProblem<'a> {
        WatchedProblem { problem: self, observer }
    }
}

impl<'a> From<&'a DesignProblem> for WatchedProblem<'a> {
    fn from(problem: &'a DesignProblem) -> Self {
        problem.watched_by(&Unobserved)
    }
}

impl WatchedProblem<'_> {
    /// Reports the evaluations so far; does the search go on?
    pub(super) fn goes_on(&self, done: usize) -> bool {
        let total = self.problem.budget().evaluations;
        self.observer.observe(Progress { work: Work::Evaluations, done, total }).is_continue()
    }
}
