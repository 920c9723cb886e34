//! Torque that was not fitted, with a term and without it.
//!
//! ```text
//! e = Σ^{-½} (y_k − W_k β̂)        ẽ = Σ^{-½} (y_k − W_k β̃)        sample k was no part of the fit
//! D = Σ_k |e|² − |ẽ|² = − Σ_k |δ|² − Σ_k 2 eᵀδ        δ = ẽ − e
//! s² = Σ_b c_b²,   c_b = Σ_{k in b} 2 eᵀδ        D ± t s        t of 19 degrees of freedom
//! ```
//! The difference δ of the two predictions is known: chance is in the errors e alone. Their sums c over twenty consecutive parts are nearly
//! independent from part to part, which knows their correlation in time. A term acts more in some parts of a motion than in others; that is
//! no chance, and is not in the interval. So it is that of this motion: noise and model error could have been others, the motion not.
//!
//! A t interval of the ratios of the sums, part by part, takes unlike parts for chance, and misses terms that act in a few of them.
//!
//! Reference: F. X. Diebold, R. S. Mariano, "Comparing predictive accuracy", Journal of Business & Economic Statistics 13(3), 1995.

use nalgebra::{DMatrix, DVector};

use super::evidence::{HeldOutChange, HeldOutData};
use super::restriction::Restriction;
use crate::estimation::error::EstimationError;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::observation::Observation;
use crate::linalg::{BlockWhitening, LeastSquares};
use crate::statistics::student_quantile;

/// Parts of the recording of which each in turn is predicted.
const FOLDS: usize = 5;

/// Parts over which chance is summed.
const PARTS: usize = 20;

/// A fit and what it has not seen.
struct Fold {
    beta: DVector<f64>,
    inverse: DMatrix<f64>,
    /// Weighted equations of what was not fitted, rows × b, and torque.
    h: DMatrix<f64>,
    z: DVector<f64>,
    /// Joints n.
    dof: usize,
    /// Equations among them.
    equations: usize,
}

/// Fits of all candidates, with the torque that they have not seen.
pub(super) struct Predictions {
    data: HeldOutData,
    folds: Vec<Fold>,
}

impl Predictions {
    /// On held-out equations where there are some, else on folds of the recording; `None` where a part of it does not determine the
    /// parameters.
    ///
    /// # Errors
    /// [`EstimationError`] where held-out equations are not those of this base.
    pub(super) fn new(
        observation: &Observation,
        weights: &BlockWhitening,
        fit: &LeastSquares,
        held_out: &[Observation],
    ) -> Result<Option<Self>, EstimationError> {
        let folds: Option<Vec<Fold>> = if held_out.is_empty() {
            (0..FOLDS).map(|fold| folded(observation, weights, fold)).collect()
        } else {
            let of = held_out.iter().map(|unseen| Fold::of(fit, weights, unseen));
            Some(of.collect::<Result<_, EstimationError>>()?)
        };
        let data = if held_out.is_empty() { HeldOutData::Folds } else { HeldOutData::Recording };
        Ok(folds.map(|folds| Self { data, folds }))
    }

    /// How the error changes by what a restriction leaves out.
    pub(super) fn change(&self, restriction: &Restriction) -> Option<HeldOutChange> {
        let mut errors = Errors::default();
        for fold in &self.folds {
            let restricted = restriction.restricted(&fold.beta, &fold.inverse)?;
            errors.add(fold.dof, &fold.errors(&restricted), &fold.errors(&fold.beta), fold.equations);
        }
        errors.change(self.data)
    }
}

/// How the error of torque that was not fitted changes from one set of equations of a recording to another of the same torque, each fold of it
/// predicted from the rest, with the weights of the second fit; `None` where a part of it does not determine the parameters.
///
/// # Errors
/// [`EstimationError`] where the equations have no answer.
pub(in crate::estimation) fn change_between(
    before: &Observation,
    after: &Observation,
) -> Result<Option<HeldOutChange>, EstimationError> {
    let linear = LinearFit::weighted(&Factorisation::new(after)?)?;
    let Some(weights) = &linear.weights else { return Ok(None) };
    let mut errors = Errors::default();
    for fold in 0..FOLDS {
        let [before, after] = [before, after].map(|observation| folded(observation, weights, fold));
        let (Some(before), Some(after)) = (before, after) else { return Ok(None) };
        errors.add(after.dof, &before.errors(&before.beta), &after.errors(&after.beta), after.equations);
    }
    Ok(errors.change(HeldOutData::Folds))
}

/// Weighted errors of torque that was not fitted, sample by sample.
#[derive(Default)]
struct Errors {
    /// |ẽ|², |e|² and 2 eᵀδ.
    samples: Vec<[f64; 3]>,
    equations: usize,
}

impl Errors {
    /// Of `dof` joints at each sample.
    fn add(&mut self, dof: usize, without: &DVector<f64>, with: &DVector<f64>, equations: usize) {
        let samples = without.as_slice().chunks_exact(dof).zip(with.as_slice().chunks_exact(dof));
        self.samples.extend(samples.map(|(without, with)| {
            let pairs = without.iter().zip(with);
            pairs.fold([0.0; 3], |[a, b, c], (o, e)| [a + o * o, b + e * e, c + 2.0 * e * (o - e)])
        }));
        self.equations += equations;
    }

    /// `None` of too few samples, and where there is no error that could fall.
    fn change(&self, data: HeldOutData) -> Option<HeldOutChange> {
        let (count, sum) = (self.samples.len(), |k: usize| self.samples.iter().map(|of| of[k]).sum::<f64>());
        let (before, after) = (sum(0), sum(1));
        if count < 2 * PARTS || before <= 0.0 {
            return None;
        }
        let part =
            |b: usize| self.samples[b * count / PARTS..(b + 1) * count / PARTS].iter().map(|of| of[2]).sum::<f64>();
        let chance: f64 = (0..PARTS).map(|b| part(b).powi(2)).sum();
        let half = student_quantile(0.975, (PARTS - 1) as f64) * chance.sqrt();
        let rms = |sum: f64| (sum / self.equations.max(1) as f64).sqrt();
        let change_ci95 = [-half, half].map(|half| ((after - before + half) / before).max(-1.0));
        Some(HeldOutChange { data, without: rms(before), with: rms(after), change_ci95 })
    }
}

impl Fold {
    fn of(fit: &LeastSquares, weights: &BlockWhitening, unseen: &Observation) -> Result<Self, EstimationError> {
        Ok(Self {
            beta: fit.solution().clone(),
            inverse: fit.inverse_information(),
            h: weights.clone().whiten(&unseen.regressor, &unseen.used)?,
            z: unseen.white(weights, &unseen.y)?,
            dof: unseen.dof,
            equations: unseen.equations(),
        })
    }

    /// Weighted errors, joint by joint of each sample.
    fn errors(&self, beta: &DVector<f64>) -> DVector<f64> {
        &self.z - &self.h * beta
    }
}

/// The fit to all but one fold of consecutive samples; `None` where it does not determine the parameters.
fn folded(observation: &Observation, weights: &BlockWhitening, fold: usize) -> Option<Fold> {
    let (n, samples) = (observation.dof, observation.samples());
    let out = fold * samples / FOLDS * n..(fold + 1) * samples / FOLDS * n;
    let seen = observation.without(|row| out.contains(&row));
    let fit = Factorisation::new(&seen).ok()?.weighted(weights).ok()?;
    // Only the fold itself.
    let rows = out.len();
    let unseen = Observation {
        regressor: observation.regressor.rows(out.start, rows).into_owned(),
        y: observation.y.rows(out.start, rows).into_owned(),
        used: observation.used[out].to_vec(),
        ..observation.clone()
    };
    Fold::of(&fit, weights, &unseen).ok()
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::seed::Seed;

    /// Two predictions whose difference is known, with errors that remember 0.6 of themselves: `Σ |δ|²` is what is gained on average.
    #[test]
    fn analytic_the_interval_covers_the_change_where_the_difference_acts_in_few_parts() {
        let (mut covered, mut improved, mut rng) = (0, 0, Seed::new(17).stream("errors", 0));
        let draws = 400;
        for _ in 0..draws {
            let (mut errors, mut last, mut gain) = (Errors::default(), 0.0, 0.0);
            for k in 0..800 {
                let z: f64 = StandardNormal.sample(&mut rng);
                last = 0.6 * last + 0.8 * z;
                let t = k as f64 / 800.0;
                // In a third of the time nearly nothing.
                let delta = libm::pow(libm::sin(9.0 * t), 4.0) * libm::cos(150.0 * t);
                gain += delta * delta;
                errors.add(1, &DVector::from_element(1, last + delta), &DVector::from_element(1, last), 1);
            }
            let change = errors.change(HeldOutData::Folds).unwrap();
            let before = change.without * change.without * 800.0;
            covered += i32::from((change.change_ci95[0]..change.change_ci95[1]).contains(&(-gain / before)));
            improved += i32::from(change.is_improvement());
        }
        // 95 %, by five standard deviations of their binomial count at most.
        assert!(f64::from(covered) > 0.895 * f64::from(draws), "{covered}");
        assert!(improved > draws / 2, "{improved}");
    }
}
