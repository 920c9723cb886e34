//! One set of terms, fitted, and what it says of each of them.

use nalgebra::{DMatrix, DVector};

use super::beyond_motion::BeyondMotion;
use super::evidence::{TermEvidence, Verdict};
use super::prediction_error::Predictions;
use super::restriction::Restriction;
use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::identification::Identification;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::residual::residual_noise;
use crate::estimation::termination::Termination;
use crate::model::ParameterKind;
use crate::model::term::STRIBECK;
use crate::signal::Samples;
use crate::statistics::student_quantile;

/// Standard deviations beyond which a coefficient of the wrong sign is no chance.
const BEYOND_NOISE: f64 = 3.0;

/// One set of terms, fitted.
pub(super) struct Step {
    pub(super) observation: Observation,
    pub(super) linear: LinearFit,
    /// Covariance of β̂ and what it is known to.
    covariance: DMatrix<f64>,
    freedom: f64,
    pub(super) effective: f64,
    predictions: Option<Predictions>,
}

impl Step {
    /// By its equations and those that are held out.
    pub(super) fn of(
        identification: &Identification,
        observation: Observation,
        samples: &Samples,
        unseen: &[Observation],
    ) -> Result<Self, EstimationError> {
        let (linear, estimate) = {
            let equations = Factorisation::new(&observation)?;
            let problem =
                EstimationProblem { factorisation: Some(&equations), ..identification.problem(&observation, samples) };
            let problem = EstimationProblem { nominal: None, ..problem };
            let linear = LinearFit::weighted(&equations)?;
            let estimate = linear.estimate("wls", &problem, &linear.fit, Termination::Direct)?;
            (linear, estimate)
        };
        let predictions = |weights| Predictions::new(&observation, weights, &linear.fit, unseen);
        let predictions = linear.weights.as_ref().map_or(Ok(None), predictions)?;
        Ok(Self {
            covariance: estimate.covariance_matrix(),
            freedom: estimate.degrees_of_freedom,
            effective: effective_equations(&observation, linear.fit.solution()),
            predictions,
            linear,
            observation,
        })
    }

    /// Coefficients of the term of this word, and those that are estimated beside them.
    pub(super) fn coefficients(&self, word: &str) -> [Vec<BeyondMotion>; 2] {
        let t = student_quantile(0.975, self.freedom);
        let (solution, base) = (self.linear.fit.solution(), &self.observation.base);
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for ((at, parameter), unit) in base.names().into_iter().enumerate().zip(&self.observation.parameter_units) {
            let (value, std) = (solution[at], self.covariance[(at, at)].max(0.0).sqrt());
            let ci95 = [value - t * std, value + t * std];
            let to = if is_of(base.parameters[base.kept[at]].kind, word) { &mut own } else { &mut others };
            to.push(BeyondMotion { term: word.to_owned(), parameter, value, ci95, unit: unit.clone() });
        }
        [own, others]
    }

    /// What speaks for the term of a word.
    pub(super) fn evidence(&self, word: &str, level: f64) -> TermEvidence {
        let base = &self.observation.base;
        let is_term = |c: usize| is_of(base.parameters[c].kind, word);
        let std = self.covariance.diagonal().map(|v| v.max(f64::MIN_POSITIVE).sqrt());
        let restriction = Restriction::of(base, is_term, &std);
        let coefficients = restriction.len();
        if coefficients == 0 {
            return TermEvidence::untested(word);
        }
        let Some(wald) = restriction.wald(self.linear.fit.solution(), &self.covariance) else {
            return TermEvidence::untested(word);
        };
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
        let predicts = held_out.is_some_and(|change| change.is_improvement());
        let negative = self.negative(word);
        let verdict = match (f.p_value <= level && negative.is_empty(), bic < 0.0 && predicts) {
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
            negative,
            alike: Vec::new(),
        }
    }

    /// Coefficients of static friction that are below zero by more than [`BEYOND_NOISE`] standard deviations: friction that rises from rest and
    /// does not fall.
    fn negative(&self, word: &str) -> Vec<String> {
        if word != STRIBECK.entry().name {
            return Vec::new();
        }
        let (base, solution) = (&self.observation.base, self.linear.fit.solution());
        let below = |at: usize| solution[at] < -BEYOND_NOISE * self.covariance[(at, at)].max(0.0).sqrt();
        let own = |&(at, _): &(usize, String)| is_of(base.parameters[base.kept[at]].kind, word) && below(at);
        base.names().into_iter().enumerate().filter(own).map(|(_, name)| name).collect()
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

fn is_of(kind: ParameterKind, word: &str) -> bool {
    kind.term().is_some_and(|term| term.entry().name == word)
}
