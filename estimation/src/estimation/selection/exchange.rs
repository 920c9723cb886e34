//! Terms that could stand for each other.
//!
//! ```text
//! ΔBIC = BIC(S − T + U) − BIC(S)        T in the set S, U not
//! ```
//! Leaving out one term after the other does not see that another one would have done as well: friction that differs forward and backward
//! and an offset are one and the same but near rest. So each term of the set is exchanged for each that is not in it. Where that is better
//! by more than 6 (odds of 20 to 1) the exchange is made; where it is neither better nor worse by so much, the data do not
//! decide between the two: the one that stands first in the list of terms is taken, and each is named with the other. A term that left for want of a
//! test has another chance beside the final set.

use super::evidence::{TermEvidence, Verdict};
use super::search::{Kept, Search, with_word, without, words_of};
use crate::estimation::error::EstimationError;
use crate::estimation::identification::Identification;
use crate::model::Columns;
use crate::model::term::Term;

/// Difference of BIC at which data decide between two sets: 2 ln 20.
const DECIDED: f64 = 6.0;

/// What exchanging single terms shows.
pub(super) struct Exchanges {
    /// A set that is better.
    pub(super) better: Option<Columns>,
    /// Pairs between which the data do not decide.
    alike: Vec<(&'static str, String)>,
}

impl Exchanges {
    /// The words that could stand for this one.
    pub(super) fn alike_to(&self, word: &str) -> Vec<String> {
        let of = |(own, other): &(&'static str, String)| match (*own == word, other == word) {
            (true, _) => Some(other.clone()),
            (false, true) => Some((*own).to_owned()),
            (false, false) => None,
        };
        self.alike.iter().filter_map(of).collect()
    }
}

impl<F: Fn(Columns) -> Result<Identification, EstimationError>> Search<'_, F> {
    /// Exchanges each term of a set, and tests beside it what was left out without a test.
    pub(super) fn exchanges(&self, set: &Kept, left_out: &mut [TermEvidence]) -> Result<Exchanges, EstimationError> {
        for term in left_out.iter_mut().filter(|term| term.verdict == Verdict::NotExcited) {
            let Some(evidence) = self.beside(set.columns, &term.term)? else { continue };
            if evidence.verdict == Verdict::Supported {
                let better = Some(with_word(set.columns, &term.term));
                return Ok(Exchanges { better, alike: Vec::new() });
            }
            *term = evidence;
        }
        let Some(own) = self.criterion(set.columns, &set.step)? else {
            return Ok(Exchanges { better: None, alike: Vec::new() });
        };
        let (mut best, mut alike) = ((-DECIDED, None), Vec::new());
        let mut earlier = None;
        for word in words_of(set.columns) {
            let less = without(set.columns, word);
            // What errs on torque that was not fitted stays out, however well it fits.
            let errs = |term: &TermEvidence| {
                !term.negative.is_empty() || term.held_out.is_some_and(|change| !change.is_improvement())
            };
            for term in left_out.iter().filter(|term| !errs(term)) {
                let exchanged = with_word(less, &term.term);
                let Some(other) = self.criterion(exchanged, &set.step)? else { continue };
                let difference = other - own;
                if difference < best.0 {
                    best = (difference, Some(exchanged));
                } else if difference.abs() <= DECIDED {
                    if place(&term.term) < place(word) {
                        earlier = Some(exchanged);
                    }
                    alike.push((word, term.term.clone()));
                }
            }
        }
        Ok(Exchanges { better: best.1.or(earlier), alike })
    }
}

/// Where the first term of a word stands in the list.
fn place(word: &str) -> Option<usize> {
    Term::ALL.iter().position(|term| term.entry().name == word)
}
