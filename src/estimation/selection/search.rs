//! Backward elimination.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::beyond_motion::{Beside, BeyondMotion};
use super::evidence::{Selection, TermEvidence, Verdict};
use super::prediction_error::Predictions;
use super::restriction::Restriction;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::{
    EstimationError, EstimationProblem, Factorisation, Identification, Observation, Termination, residual_noise,
};
use crate::model::term::Term;
use crate::model::{Columns, ParameterKind};
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Probability that the terms of an arm without any are reported.
const LEVEL: f64 = 0.05;

/// Compares the sets of terms among `candidates` by a recording, with weighted least squares, and says of each term what the data decide.
///
/// `of` gives what is estimated for a choice of columns; `held_out` are samples that were no part of the recording, or none: then each fifth
/// of the recording in turn is predicted by the others.
///
/// # Errors
/// [`EstimationError`] where the links' parameters alone cannot be estimated, or the samples are of another robot.
pub fn select<'a>(
    of: impl Fn(Columns) -> Result<Identification<'a>, EstimationError>,
    samples: &Samples,
    held_out: &[Samples],
    candidates: Columns,
) -> Result<Selection, EstimationError> {
    let words = words_of(candidates);
    let search = Search { of, samples, held_out, level: LEVEL / words.len().max(1) as f64 };
    let motion = candidates.terms().filter(|term| term.entry().needs.is_motion());
    let mut columns = motion.fold(Columns::RIGID, Columns::with);
    let (mut left_out, mut seen) = (Vec::new(), Vec::new());
    let (set, exchanges) = loop {
        let set = search.eliminated(columns, &mut left_out)?;
        seen.push(set.columns);
        let exchanges = search.exchanges(&set, &mut left_out)?;
        match exchanges.better {
            Some(better) if !seen.contains(&better) => {
                // What comes in is tested again, and what goes out beside it.
                left_out.retain(|term: &TermEvidence| !words_of(better).contains(&term.term.as_str()));
                let gone = words_of(set.columns).into_iter().filter(|word| !words_of(better).contains(word));
                left_out.extend(gone.map(untested));
                columns = better;
            }
            Some(_) | None => break (set, exchanges),
        }
    };
    let Kept { identification, step, mut terms, columns } = set;
    terms.append(&mut left_out);
    let (mut beyond, mut beside) = (Vec::new(), Vec::new());
    let rest: Vec<_> = words.iter().filter(|word| terms.iter().all(|term| term.term != **word)).collect();
    for word in rest {
        let mut tested = search.beyond_motion(&identification, &step, word)?;
        terms.push(tested.evidence);
        beyond.append(&mut tested.found);
        beside.append(&mut tested.beside);
    }
    for term in &mut terms {
        term.alike = exchanges.alike_to(&term.term);
    }
    terms.sort_by_key(|term| words.iter().position(|word| *word == term.term));
    Ok(Selection {
        columns: columns.to_string(),
        level: search.level,
        effective_equations: step.effective,
        equations: step.observation.equations(),
        terms,
        beyond_motion: beyond,
        parameters_beside: beside,
    })
}

/// What all steps share.
pub(super) struct Search<'s, F> {
    of: F,
    samples: &'s Samples,
    held_out: &'s [Samples],
    level: f64,
}

/// A set of which every term is supported.
pub(super) struct Kept<'a> {
    pub(super) columns: Columns,
    identification: Identification<'a>,
    pub(super) step: Step,
    terms: Vec<TermEvidence>,
}

impl<'a, F: Fn(Columns) -> Result<Identification<'a>, EstimationError>> Search<'_, F> {
    /// Leaves out the least supported term until all are supported.
    fn eliminated(&self, mut columns: Columns, left_out: &mut Vec<TermEvidence>) -> Result<Kept<'a>, EstimationError> {
        loop {
            let identification = (self.of)(columns)?;
            let step = match Step::new(&identification, self.samples, self.held_out) {
                Ok(step) => step,
                // The motion does not distinguish a term from the others: it is the first to go.
                Err(
                    EstimationError::NotExcited { parameter, .. }
                    | EstimationError::OutsideOfEquations { parameter, .. },
                ) if !words_of(columns).is_empty() => {
                    let word = term_of(&identification, &parameter).unwrap_or_else(|| words_of(columns)[0]);
                    left_out.push(untested(word));
                    columns = without(columns, word);
                    continue;
                }
                Err(EstimationError::TooFewEquations { .. }) if !words_of(columns).is_empty() => {
                    let all = words_of(columns);
                    let word = all[all.len() - 1];
                    left_out.push(untested(word));
                    columns = without(columns, word);
                    continue;
                }
                Err(error) => return Err(error),
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
        match Step::new(&(self.of)(with_word(columns, word))?, self.samples, self.held_out) {
            Ok(step) => Ok(Some(step.evidence(word, self.level))),
            Err(
                EstimationError::NotExcited { .. }
                | EstimationError::OutsideOfEquations { .. }
                | EstimationError::TooFewEquations { .. },
            ) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// N_e ln of the sum of weighted squares and b ln N_e of a set, by the weights of another; `None` where the motion does not distinguish
    /// its columns.
    pub(super) fn criterion(&self, columns: Columns, by: &Step) -> Result<Option<f64>, EstimationError> {
        let identification = (self.of)(columns)?;
        let Some(weights) = &by.linear.weights else { return Ok(None) };
        let fitted = identification.observation(self.samples).and_then(|observation| {
            let fit = Factorisation::new(&observation)?.weighted(weights)?;
            let residual = observation.residual(fit.solution());
            let column = DMatrix::from_column_slice(residual.len(), 1, residual.as_slice());
            Ok((weights.clone().whiten(&column, &observation.used)?.norm_squared(), fit.solution().len()))
        });
        match fitted {
            Ok((sum, b)) => Ok(Some(by.effective * libm::log(sum) + b as f64 * libm::log(by.effective))),
            Err(
                EstimationError::NotExcited { .. }
                | EstimationError::OutsideOfEquations { .. }
                | EstimationError::TooFewEquations { .. },
            ) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The evidence for a term that is no column, and its coefficients where it is supported.
    fn beyond_motion(
        &self,
        identification: &Identification<'a>,
        step: &Step,
        word: &str,
    ) -> Result<Tested, EstimationError> {
        let robot = identification.problem(&step.observation, self.samples).robot;
        let beta = step.linear.fit.solution();
        let beside = match robot {
            Some(robot) => Beside::of(word, robot, (&step.observation, self.samples), beta.as_slice()),
            None => Ok(None),
        };
        let beside = match beside {
            Ok(Some(beside)) => beside,
            Ok(None) | Err(EstimationError::NotExcited { .. }) => return Ok(Tested::not(word)),
            Err(error) => return Err(error),
        };
        let held_out: &[Samples] = if beside.is_of_one_record() { &[] } else { self.held_out };
        let unseen = held_out.iter().map(|samples| Ok(beside.extended(&identification.unseen(samples)?, samples)));
        let unseen = unseen.collect::<Result<Vec<_>, EstimationError>>()?;
        let observation = beside.extended(&step.observation, self.samples);
        let extended = match Step::of(identification, observation, self.samples, &unseen) {
            Ok(extended) => extended,
            Err(EstimationError::NotExcited { .. } | EstimationError::OutsideOfEquations { .. }) => {
                return Ok(Tested::not(word));
            }
            Err(error) => return Err(error),
        };
        let evidence = extended.evidence(word, self.level);
        let all = extended.observation.base.rank();
        let [found, beside] = match evidence.verdict {
            Verdict::Supported => [beta.len()..all, 0..beta.len()].map(|range| extended.coefficients(word, range)),
            Verdict::Undecided | Verdict::NotSupported | Verdict::NotExcited => [Vec::new(), Vec::new()],
        };
        Ok(Tested { evidence, found, beside })
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
    fn not(word: &str) -> Self {
        Self { evidence: untested(word), found: Vec::new(), beside: Vec::new() }
    }
}

/// One set of terms, fitted.
pub(super) struct Step {
    observation: Observation,
    linear: LinearFit,
    /// Covariance of β̂ and what it is known to.
    covariance: DMatrix<f64>,
    freedom: f64,
    pub(super) effective: f64,
    predictions: Option<Predictions>,
}

impl Step {
    fn new(
        identification: &Identification<'_>,
        samples: &Samples,
        held_out: &[Samples],
    ) -> Result<Self, EstimationError> {
        let observation = identification.observation(samples)?;
        let unseen = held_out.iter().map(|samples| identification.unseen(samples));
        Self::of(identification, observation, samples, &unseen.collect::<Result<Vec<_>, EstimationError>>()?)
    }

    /// The same for equations and held-out ones that are there.
    fn of(
        identification: &Identification<'_>,
        observation: Observation,
        samples: &Samples,
        unseen: &[Observation],
    ) -> Result<Self, EstimationError> {
        let (linear, estimate) = {
            let equations = Factorisation::new(&observation)?;
            let problem = identification.problem(&observation, samples).with_factorisation(&equations);
            let problem = EstimationProblem { nominal: None, ..problem };
            let linear = LinearFit::weighted(&equations)?;
            let estimate = linear.estimate("wls", &problem, &linear.fit, Termination::Direct)?;
            (linear, estimate)
        };
        let predictions = match &linear.weights {
            Some(weights) => Predictions::new(&observation, (weights, &linear.fit), unseen)?,
            None => None,
        };
        Ok(Self {
            covariance: estimate.covariance_matrix(),
            freedom: estimate.degrees_of_freedom,
            effective: effective_equations(&observation, linear.fit.solution()),
            predictions,
            linear,
            observation,
        })
    }

    /// Coefficients, as those found with the term of this word.
    fn coefficients(&self, word: &str, range: Range<usize>) -> Vec<BeyondMotion> {
        let t = student_quantile(0.975, self.freedom);
        let solution = self.linear.fit.solution();
        let names = self.observation.base.names().into_iter().zip(&self.observation.parameter_units);
        let coefficient = |(at, (parameter, unit)): (usize, (String, &String))| {
            let (value, std) = (solution[at], self.covariance[(at, at)].max(0.0).sqrt());
            let ci95 = [value - t * std, value + t * std];
            BeyondMotion { term: word.to_owned(), parameter, value, ci95, unit: unit.clone() }
        };
        names.enumerate().skip(range.start).take(range.len()).map(coefficient).collect()
    }

    fn evidence(&self, word: &str, level: f64) -> TermEvidence {
        let base = &self.observation.base;
        let is_term = |c: usize| is_of(base.parameters[c].kind, word);
        let std = self.covariance.diagonal().map(|v| v.max(f64::MIN_POSITIVE).sqrt());
        let restriction = Restriction::of(base, is_term, &std);
        let coefficients = restriction.len();
        if coefficients == 0 {
            return untested(word);
        }
        let Some(wald) = restriction.wald(self.linear.fit.solution(), &self.covariance) else { return untested(word) };
        let (r, count) = (coefficients as f64, self.effective);
        let f = restriction.test(wald, self.freedom);
        // Twice the logarithm of the ratio of likelihoods, for a variance that is known or that of the residual.
        let left = 1.0 - base.rank() as f64 / self.observation.equations() as f64;
        let likelihood = match self.freedom.is_finite() {
            true => count * libm::log1p(wald / (count * left.max(f64::EPSILON))),
            false => wald,
        };
        let (aic, bic) = (2.0 * r - likelihood, r * libm::log(count) - likelihood);
        let held_out = self.predictions.as_ref().and_then(|predictions| predictions.change(&restriction));
        let predicts = held_out.is_some_and(|change| change.with < change.without);
        let verdict = match (f.p_value <= level, bic < 0.0 && predicts) {
            (true, true) => Verdict::Supported,
            (true, false) => Verdict::Undecided,
            (false, _) => Verdict::NotSupported,
        };
        TermEvidence {
            term: word.to_owned(),
            verdict,
            coefficients,
            f: Some(f),
            aic: Some(aic),
            bic: Some(bic),
            held_out,
            alike: Vec::new(),
        }
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

/// N_e = `Σ_i M_i / max(1, 1 + 2 Σ_l ρ_i(l))` of the residual's correlation in time: as many independent equations determine
/// a mean as well.
pub(super) fn effective_equations(observation: &Observation, beta: &DVector<f64>) -> f64 {
    let noise = residual_noise(observation, &observation.residual(beta));
    let n = observation.dof;
    (0..n)
        .map(|i| {
            let equations = observation.used.iter().skip(i).step_by(n).filter(|used| **used).count() as f64;
            let related: f64 = (1..=noise.length()).map(|l| noise.correlation(i, l)).sum();
            equations / (1.0 + 2.0 * related).max(1.0)
        })
        .sum()
}

fn untested(word: &str) -> TermEvidence {
    TermEvidence {
        term: word.to_owned(),
        verdict: Verdict::NotExcited,
        coefficients: 0,
        f: None,
        aic: None,
        bic: None,
        held_out: None,
        alike: Vec::new(),
    }
}

/// The words of the terms of these columns, each once.
pub(super) fn words_of(columns: Columns) -> Vec<&'static str> {
    let mut words = Vec::new();
    for term in columns.terms() {
        if !words.contains(&term.entry().name) {
            words.push(term.entry().name);
        }
    }
    words
}

fn is_of(kind: ParameterKind, word: &str) -> bool {
    kind.term().is_some_and(|term| term.entry().name == word)
}

/// The columns without the terms of a word.
pub(super) fn without(columns: Columns, word: &str) -> Columns {
    let gone: Vec<_> = columns.terms().filter(|term| term.entry().name == word).collect();
    gone.into_iter().fold(columns, Columns::without)
}

/// The columns with the terms of a word.
pub(super) fn with_word(columns: Columns, word: &str) -> Columns {
    Term::ALL.iter().copied().filter(|term| term.entry().name == word).fold(columns, Columns::with)
}

/// The word of the term whose parameter has this name.
fn term_of(identification: &Identification<'_>, parameter: &str) -> Option<&'static str> {
    let ids = identification.base().parameters.iter();
    ids.filter(|id| id.to_string() == parameter).find_map(|id| id.kind.term().map(|term| term.entry().name))
}
