//! Which run of a study is meant.

/// One run of a study: which design, under which condition, and its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RunId {
    /// Index of the design.
    pub design: usize,
    /// Index of the condition.
    pub condition: usize,
    /// Number of the run within the design.
    pub run: u64,
}
