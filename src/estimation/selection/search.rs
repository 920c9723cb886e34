//! Backward elimination.

use nalgebra::{DMatrix, DVector};

use super::evidence::{Selection, TermEvidence, Verdict};
use super::prediction_error::Predictions;
use super::restriction::Restriction;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::{
    EstimationError, EstimationProblem, Factorisation, Identification, Observation, Termination, residual_noise,
};
use crate::model::{Columns, ParameterKind};
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
pub fn select<'a>(
    of: impl Fn(Columns) -> Result<Identification<'a>, EstimationError>,
    samples: &Samples,
    held_out: &[Samples],
    candidates: Columns,
) -> Result<Selection, EstimationError> {
    let words = words_of(candidates);
    let level = LEVEL / words.len().max(1) as f64;
    let mut columns = candidates;
    let mut left_out: Vec<TermEvidence> = Vec::new();
    loop {
        let identification = of(columns)?;
        let step = match Step::new(&identification, samples, held_out) {
            Ok(step) => step,
            // The motion does not distinguish a term from the others: it is the first to go.
            Err(EstimationError::NotExcited { parameter, .. }) if !words_of(columns).is_empty() => {
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
        let evidence: Vec<TermEvidence> =
            words_of(columns).into_iter().map(|word| step.evidence(&identification, word, level)).collect();
        let unsupported = evidence.iter().filter(|term| term.verdict != Verdict::Supported);
        match unsupported.max_by(|a, b| weakness(a).total_cmp(&weakness(b))) {
            Some(worst) => {
                columns = without(columns, &worst.term);
                left_out.push(worst.clone());
            }
            None => {
                let mut terms = evidence;
                terms.append(&mut left_out);
                terms.sort_by_key(|term| words.iter().position(|word| *word == term.term));
                return Ok(Selection {
                    columns: columns.to_string(),
                    level,
                    effective_equations: step.effective,
                    equations: step.observation.equations(),
                    terms,
                });
            }
        }
    }
}

/// One set of terms, fitted.
struct Step {
    observation: Observation,
    linear: LinearFit,
    /// Covariance of β̂ and what it is known to.
    covariance: DMatrix<f64>,
    freedom: f64,
    effective: f64,
    predictions: Option<Predictions>,
}

impl Step {
    fn new(
        identification: &Identification<'_>,
        samples: &Samples,
        held_out: &[Samples],
    ) -> Result<Self, EstimationError> {
        let observation = identification.observation(samples)?;
        let (linear, estimate) = {
            let equations = Factorisation::new(&observation)?;
            let problem = identification.problem(&observation, samples).with_factorisation(&equations);
            let problem = EstimationProblem { nominal: None, ..problem };
            let linear = LinearFit::weighted(&equations)?;
            let estimate = linear.estimate("wls", &problem, &linear.fit, Termination::Direct)?;
            (linear, estimate)
        };
        let predictions = match &linear.weights {
            Some(weights) => Predictions::new(identification, &observation, (weights, &linear.fit), held_out)?,
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

    fn evidence(&self, identification: &Identification<'_>, word: &str, level: f64) -> TermEvidence {
        let base = identification.base();
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
    }
}

/// The words of the terms of these columns, each once.
fn words_of(columns: Columns) -> Vec<&'static str> {
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
fn without(columns: Columns, word: &str) -> Columns {
    let gone: Vec<_> = columns.terms().filter(|term| term.entry().name == word).collect();
    gone.into_iter().fold(columns, Columns::without)
}

/// The word of the term whose parameter has this name.
fn term_of(identification: &Identification<'_>, parameter: &str) -> Option<&'static str> {
    let ids = identification.base().parameters.iter();
    ids.filter(|id| id.to_string() == parameter).find_map(|id| id.kind.term().map(|term| term.entry().name))
}
