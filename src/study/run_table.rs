//! The numbers of all runs that findings are made of, column by column, wherever they are held.
//!
//! A study may have more runs than memory holds estimates: [`Evidence`](super::Evidence) asks for one number of many runs
//! at a time.

use std::fmt::Debug;
use std::ops::Range;

use nalgebra::DVector;

use super::error::StudyError;
use super::metric::Metric;
use super::outcome::Outcome;
use super::status_count::StatusCount;

/// One number of a run. Estimators and base parameters are counted from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum RunNumber {
    /// Index of the truth of its arm.
    Truth,
    /// A metric of the estimate of one estimator; [`Metric::LogVolume`] is not defined for a single run.
    Metric { estimator: usize, metric: Metric },
    /// Error β̂ − β of a base parameter by one estimator.
    Error { estimator: usize, parameter: usize },
    /// Standard deviation that the estimator states.
    Std { estimator: usize, parameter: usize },
    /// Half width of the 95 % interval that the estimator states.
    HalfWidth { estimator: usize, parameter: usize },
}

impl RunNumber {
    /// Every number of a run.
    pub fn all(estimators: usize, parameters: usize) -> Vec<Self> {
        let mut all = vec![Self::Truth];
        for estimator in 0..estimators {
            all.extend(
                Metric::ALL
                    .iter()
                    .filter(|metric| !metric.is_logarithmic())
                    .map(|&metric| Self::Metric { estimator, metric }),
            );
            all.extend((0..parameters).map(|parameter| Self::Error { estimator, parameter }));
            all.extend((0..parameters).map(|parameter| Self::Std { estimator, parameter }));
            all.extend((0..parameters).map(|parameter| Self::HalfWidth { estimator, parameter }));
        }
        all
    }

    /// Its value in an outcome, `None` where the run or the estimator gave none; `truths` are the true base parameters (b)
    /// by [`Outcome::truth`].
    pub fn value(self, outcome: &Outcome, truths: &[DVector<f64>]) -> Option<f64> {
        let scored = |estimator: usize| outcome.estimates.get(estimator).filter(|estimate| estimate.score.is_some());
        match self {
            Self::Truth => Some(outcome.truth as f64),
            Self::Metric { estimator, metric } => metric.value(scored(estimator)?),
            Self::Error { estimator, parameter } => {
                Some(scored(estimator)?.beta[parameter] - truths[outcome.truth][parameter])
            }
            Self::Std { estimator, parameter } => Some(scored(estimator)?.std[parameter]),
            Self::HalfWidth { estimator, parameter } => Some(scored(estimator)?.half_width[parameter]),
        }
    }
}

/// The numbers of all runs of a study.
pub trait RunTable: Debug {
    /// How many runs of a design there are under a condition.
    fn runs(&self, design: usize, condition: usize) -> usize;

    /// One number of some runs of a design under a condition, in the order of the runs; `None` where a run has none.
    ///
    /// # Errors
    /// [`StudyError::Runs`] where they cannot be read.
    fn numbers(
        &self,
        design: usize,
        condition: usize,
        range: Range<usize>,
        number: RunNumber,
    ) -> Result<Vec<Option<f64>>, StudyError>;

    /// How the runs under a condition ended.
    fn statuses(&self, condition: usize) -> Vec<StatusCount>;
}

/// Outcomes that are held in memory, sorted by design and run.
#[derive(Clone, Copy, Debug)]
pub struct OutcomeTable<'a> {
    /// The outcomes.
    pub outcomes: &'a [Outcome],
    /// True base parameters (b) by [`Outcome::truth`].
    pub truths: &'a [DVector<f64>],
}

impl OutcomeTable<'_> {
    fn outcomes_of(&self, design: usize, condition: usize) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter().filter(move |outcome| (outcome.design, outcome.condition) == (design, condition))
    }
}

impl RunTable for OutcomeTable<'_> {
    fn runs(&self, design: usize, condition: usize) -> usize {
        self.outcomes_of(design, condition).count()
    }

    fn numbers(
        &self,
        design: usize,
        condition: usize,
        range: Range<usize>,
        number: RunNumber,
    ) -> Result<Vec<Option<f64>>, StudyError> {
        let runs = self.outcomes_of(design, condition).skip(range.start).take(range.len());
        Ok(runs.map(|outcome| number.value(outcome, self.truths)).collect())
    }

    fn statuses(&self, condition: usize) -> Vec<StatusCount> {
        StatusCount::count(self.outcomes.iter().filter(|outcome| outcome.condition == condition))
    }
}
