//! What a study answers.

use std::path::PathBuf;

use armid::study::{RobotsSummary, StudyResult};

use super::looks::Looks;
use super::part::Part;

/// How the performance of a study ended.
#[derive(Clone, Debug, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StudyAnswer {
    /// The whole study is stored.
    Whole(Box<StudySummary>),
    /// The whole study is stored for each of its robots.
    OnRobots(Box<RobotsAnswer>),
    /// A part of the study is in the folder.
    Part {
        /// Which.
        part: Part,
        /// Where.
        folder: PathBuf,
    },
    /// An observer ended it; what was finished is in the folder.
    Interrupted {
        /// Where.
        folder: PathBuf,
    },
}

/// A study that is summed up and stored.
#[derive(Clone, Debug, serde::Serialize)]
pub struct StudySummary {
    /// What it found.
    pub result: StudyResult,
    /// How many runs it has.
    pub runs: usize,
    /// How many of them failed.
    pub failed: usize,
    /// Its page; none where every run failed.
    pub report: Option<PathBuf>,
    /// The looks of a study that was to end at a narrow interval.
    pub looks: Option<Looks>,
}

impl StudySummary {
    /// Did some run succeed, and is the interval that was wanted narrow enough?
    pub fn is_positive(&self) -> bool {
        self.failed < self.runs && self.looks.as_ref().is_none_or(Looks::is_met)
    }
}

/// A study that is stored for each of several robots.
#[derive(Clone, Debug, serde::Serialize)]
pub struct RobotsAnswer {
    /// Comparisons on all robots.
    pub summary: RobotsSummary,
    /// The page.
    pub report: PathBuf,
    /// Robots on which every run failed.
    pub without_result: Vec<String>,
}
