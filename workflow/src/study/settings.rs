//! What a study is asked for.

use std::path::PathBuf;

use armid::study::OwnMethods;

use super::part::Part;

/// How a study is performed.
#[derive(Clone, Debug, Default)]
pub struct StudySettings {
    /// The folder of its results.
    pub output: PathBuf,
    /// The folder at which relative paths of the plan begin.
    pub beside: Option<PathBuf>,
    /// Threads; all cores where 0.
    pub threads: usize,
    /// Goes on with finished work in the folder.
    pub resume: bool,
    /// Which part is performed.
    pub part: Part,
    /// Folders that hold the designs of a part with runs alone.
    pub designs_from: Vec<PathBuf>,
    /// Methods from outside that the plan names.
    pub own: OwnMethods,
    /// The interval at which it may end, as [`StoppingRule`](armid::study::StoppingRule) reads it.
    pub until: Option<String>,
}
