//! Backward elimination.

use super::beyond_motion::{Beside, BeyondMotion};
use super::evidence::{Selection, TermEvidence, Verdict};
use super::step::Step;
use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::identification::Identification;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::model::term::{CURRENT_LAG, LOAD_FRICTION, Term};
use crate::model::{Columns, distinct};
use crate::signal::Samples;

/// Probability that the terms of an arm without any are reported.
const LEVEL: f64 = 0.05;

/// Compares the sets of terms among `candidates` by a recording, with weighted least squares, and says of each term what the data decide.
///
/// `of` gives what is estimated for a choice of columns; `held_out` are samples that were no part of the recording, or none: then each fifth
/// of the recording in turn is predicted by the others.
///
/// # Errors
/// [`EstimationError`] where the links' parameters alone cannot be estimated, or the samples are of another robot.
pub fn select(
    of: impl Fn(Columns) -> Result<Identification, EstimationError>,
    samples: &Samples,
    held_out: &[Samples],
    candidates: Columns,
) -> Result<Selection, EstimationError> {
    let words = words_of(candidates);
    let level = LEVEL / words.len().max(1) as f64;
    let columns =
        candidates.terms().filter(|term| term.entry().needs.is_estimable()).fold(Columns::RIGID, Columns::with_term);
    let search = |lagged| Search { of: &of, samples, held_out, level, lagged };
    let plain = search(false).selection(columns, &words)?;
    let shows = |selection: &Selection, verdicts: &[Verdict]| {
        let lag = selection.terms.iter().find(|term| term.term == CURRENT_LAG.entry().name);
        lag.is_some_and(|lag| verdicts.contains(&lag.verdict))
    };
    if !shows(&plain, &[Verdict::Supported, Verdict::Undecided]) {
        return Ok(plain);
    }
    // A term that stood for part of the lag is not to stay in the set, nor to take its part from it.
    let lagged = if_distinguished(search(true).selection(columns, &words))?;
    Ok(lagged.filter(|lagged| shows(lagged, &[Verdict::Supported])).unwrap_or(plain))
}

/// What all steps share.
pub(super) struct Search<'s, F> {
    of: &'s F,
    samples: &'s Samples,
    held_out: &'s [Samples],
    level: f64,
    /// Whether every set has the lag of the currents beside it.
    lagged: bool,
}

/// A set of which every term is supported.
pub(super) struct Kept {
    pub(super) columns: Columns,
    identification: Identification,
    pub(super) step: Step,
    terms: Vec<TermEvidence>,
}

impl<F: Fn(Columns) -> Result<Identification, EstimationError>> Search<'_, F> {
    /// The set that is selected from all these terms, and what is said of every word.
    fn selection(&self, mut columns: Columns, words: &[&'static str]) -> Result<Selection, EstimationError> {
        let (mut left_out, mut seen) = (Vec::new(), Vec::new());
        let (set, exchanges) = loop {
            let set = self.eliminated(columns, &mut left_out)?;
            seen.push(set.columns);
            let exchanges = self.exchanges(&set, &mut left_out)?;
            match exchanges.better {
                Some(better) if !seen.contains(&better) => {
                    // What comes in is tested again, and what goes out beside it.
                    left_out.retain(|term: &TermEvidence| !words_of(better).contains(&term.term.as_str()));
                    let gone = words_of(set.columns).into_iter().filter(|word| !words_of(better).contains(word));
                    left_out.extend(gone.map(TermEvidence::untested));
                    columns = better;
                }
                Some(_) | None => break (set, exchanges),
            }
        };
        let Kept { identification, step, mut terms, columns } = set;
        terms.append(&mut left_out);
        let (mut beyond_motion, mut parameters_beside) = (Vec::new(), Vec::new());
        let rest: Vec<_> = words.iter().filter(|word| terms.iter().all(|term| term.term != **word)).collect();
        for word in rest {
            let mut tested = self.beyond_motion(&identification, &step, word)?;
            terms.push(tested.evidence);
            beyond_motion.append(&mut tested.found);
            parameters_beside.append(&mut tested.beside);
        }
        for term in &mut terms {
            term.alike = exchanges.alike_to(&term.term);
        }
        terms.sort_by_key(|term| words.iter().position(|word| *word == term.term));
        Ok(Selection {
            columns: columns.to_string(),
            level: self.level,
            effective_equations: step.effective,
            equations: step.observation.equations(),
            terms,
            beyond_motion,
            parameters_beside,
        })
    }

    /// The equations of a set, and those that are held out; with the lag of the currents where all sets have it.
    fn equations(&self, of: &Identification) -> Result<(Observation, Vec<Observation>), EstimationError> {
        let observation = of.observation_of_test(self.samples)?;
        let unseen = self.held_out.iter().map(|samples| of.unseen(samples, &observation));
        let unseen = unseen.collect::<Result<Vec<_>, _>>()?;
        let Some(robot) = of.problem(&observation, self.samples).robot.filter(|_| self.lagged) else {
            return Ok((observation, unseen));
        };
        let beta = LinearFit::weighted(&Factorisation::new(&observation)?)?.fit.solution().clone();
        let word = CURRENT_LAG.entry().name;
        let Some(lag) = Beside::of(word, robot, &observation, self.samples, beta.as_slice())? else {
            let parameter = CURRENT_LAG.symbol().to_owned();
            return Err(EstimationError::NotExcited { parameter, independent: 0.0, least: 0.0 });
        };
        let unseen = unseen.iter().zip(self.held_out).map(|(unseen, samples)| lag.extended(unseen, samples));
        Ok((lag.extended(&observation, self.samples), unseen.collect()))
    }

    fn step(&self, identification: &Identification) -> Result<Step, EstimationError> {
        let (observation, unseen) = self.equations(identification)?;
        Step::of(identification, observation, self.samples, &unseen)
    }

    /// Leaves out the least supported term until all are supported.
    fn eliminated(&self, mut columns: Columns, left_out: &mut Vec<TermEvidence>) -> Result<Kept, EstimationError> {
        loop {
            let identification = (self.of)(columns)?;
            let step = match self.step(&identification) {
                Ok(step) => step,
                Err(error) => {
                    let Some(word) = first_to_go(&identification, columns, &error) else { return Err(error) };
                    left_out.push(TermEvidence::untested(word));
                    columns = without(columns, word);
                    continue;
                }
            };
            let terms: Vec<TermEvidence> =
                words_of(columns).into_iter().map(|word| step.evidence(word, self.level)).collect();
            let unsupported = terms.iter().filter(|term| term.verdict != Verdict::Supported);
            match unsupported.max_by(|a, b| weakness(a).total_cmp(&weakness(b))) {
                Some(worst) => {
                    columns = without(columns, &worst.term);
                    left_out.push(worst.clone());
                }
                None => return Ok(Kept { columns, identification, step, terms }),
            }
        }
    }

    /// A set with the terms of a word beside it, tested for that word; `None` where the motion does not distinguish them.
    pub(super) fn beside(&self, columns: Columns, word: &str) -> Result<Option<TermEvidence>, EstimationError> {
        let step = if_distinguished(self.step(&(self.of)(with_word(columns, word))?))?;
        Ok(step.map(|step| step.evidence(word, self.level)))
    }

    /// N_e ln of the sum of weighted squares and b ln N_e of a set, by the weights of another; `None` where the motion does not distinguish
    /// its columns.
    pub(super) fn criterion(&self, columns: Columns, by: &Step) -> Result<Option<f64>, EstimationError> {
        let identification = (self.of)(columns)?;
        let Some(weights) = &by.linear.weights else { return Ok(None) };
        let fitted = self.equations(&identification).and_then(|(observation, _)| {
            let fit = Factorisation::new(&observation)?.weighted(weights)?;
            let residual = observation.residual(fit.solution());
            Ok((observation.white(weights, &residual)?.norm_squared(), fit.solution().len()))
        });
        let of = |(sum, b): (f64, usize)| by.effective * libm::log(sum) + b as f64 * libm::log(by.effective);
        Ok(if_distinguished(fitted)?.map(of))
    }

    /// The evidence for a term that is no column, and its coefficients where it is supported.
    fn beyond_motion(
        &self,
        identification: &Identification,
        step: &Step,
        word: &str,
    ) -> Result<Tested, EstimationError> {
        if self.lagged && word == CURRENT_LAG.entry().name {
            return Ok(Tested::of(step, word, self.level));
        }
        let robot = identification.problem(&step.observation, self.samples).robot;
        let beta = step.linear.fit.solution();
        let of = |robot| Beside::of(word, robot, &step.observation, self.samples, beta.as_slice());
        let beside = match robot.map_or(Ok(None), of) {
            Ok(Some(beside)) => beside,
            Ok(None) | Err(EstimationError::NotExcited { .. } | EstimationError::OutsideOfEquations { .. }) => {
                return Ok(Tested::not(word));
            }
            Err(error) => return Err(error),
        };
        let unseen = if beside.is_of_one_record() { Vec::new() } else { self.equations(identification)?.1 };
        let unseen = unseen.iter().zip(self.held_out).map(|(unseen, samples)| beside.extended(unseen, samples));
        let unseen: Vec<Observation> = unseen.collect();
        let observation = beside.extended(&step.observation, self.samples);
        match Step::of(identification, observation, self.samples, &unseen) {
            Ok(extended) => Ok(Tested::of(&extended, word, self.level)),
            Err(EstimationError::NotExcited { .. } | EstimationError::OutsideOfEquations { .. }) => {
                Ok(Tested::not(word))
            }
            Err(error) => Err(error),
        }
    }
}

/// A term that is no column, tested beside a set.
struct Tested {
    evidence: TermEvidence,
    /// Its coefficients, where it is supported.
    found: Vec<BeyondMotion>,
    /// Those of the set with it, where it is supported.
    beside: Vec<BeyondMotion>,
}

impl Tested {
    /// By a step that has its columns.
    fn of(step: &Step, word: &str, level: f64) -> Self {
        let evidence = step.evidence(word, level);
        let [found, beside] = match evidence.verdict {
            Verdict::Supported => step.coefficients(word),
            Verdict::Undecided | Verdict::NotSupported | Verdict::NotExcited => [Vec::new(), Vec::new()],
        };
        Self { evidence, found, beside }
    }

    fn not(word: &str) -> Self {
        Self { evidence: TermEvidence::untested(word), found: Vec::new(), beside: Vec::new() }
    }
}

/// How little speaks for a term: not tested first, then by p, then by BIC.
fn weakness(term: &TermEvidence) -> f64 {
    match (&term.f, term.bic) {
        (Some(f), Some(bic)) if f.p_value > 0.0 => libm::log(f.p_value) + 1e-12 * bic,
        (Some(_), Some(bic)) => -1e6 + 1e-6 * bic,
        _ => f64::INFINITY,
    }
}

/// The words of the terms of these columns, each once.
pub(super) fn words_of(columns: Columns) -> Vec<&'static str> {
    distinct(columns.terms().map(|term| term.entry().name))
}

/// The columns without the terms of a word.
pub(super) fn without(columns: Columns, word: &str) -> Columns {
    let gone: Vec<_> = columns.terms().filter(|term| term.entry().name == word).collect();
    gone.into_iter().fold(columns, Columns::without_term)
}

/// The columns with the terms of a word.
pub(super) fn with_word(columns: Columns, word: &str) -> Columns {
    Term::ALL.iter().copied().filter(|term| term.entry().name == word).fold(columns, Columns::with_term)
}

/// The word of the term without which equations may be solved: the one that the motion does not distinguish from the others, whose load
/// does not rest, or the last of too many.
fn first_to_go(of: &Identification, columns: Columns, error: &EstimationError) -> Option<&'static str> {
    let words = words_of(columns);
    match error {
        EstimationError::NotExcited { parameter, .. } | EstimationError::OutsideOfEquations { parameter, .. }
            if !parameter.starts_with(CURRENT_LAG.symbol()) =>
        {
            words.first().map(|&first| term_of(of, parameter).unwrap_or(first))
        }
        EstimationError::LoadNotAtRest { .. } => Some(LOAD_FRICTION.entry().name),
        EstimationError::TooFewEquations { .. } => words.last().copied(),
        _ => None,
    }
}

/// A fit; `None` where the motion does not distinguish its columns.
fn if_distinguished<T>(fitted: Result<T, EstimationError>) -> Result<Option<T>, EstimationError> {
    match fitted {
        Err(
            EstimationError::NotExcited { .. }
            | EstimationError::OutsideOfEquations { .. }
            | EstimationError::TooFewEquations { .. }
            | EstimationError::LoadNotAtRest { .. },
        ) => Ok(None),
        fitted => fitted.map(Some),
    }
}

/// The word of the term whose parameter has this name.
fn term_of(identification: &Identification, parameter: &str) -> Option<&'static str> {
    let ids = identification.base().parameters.iter();
    ids.filter(|id| id.to_string() == parameter).find_map(|id| id.kind.term().map(|term| term.entry().name))
}
