//! Torque that was not fitted, with a term and without it.
//!
//! ```text
//! d_k = |Σ^{-½} (y_k − W_k β̃)|² − |Σ^{-½} (y_k − W_k β̂)|²        sample k was no part of the fit
//! ```
//! The ratio of the two sums in ten consecutive parts is nearly independent from part to part, so that the t interval of its logarithm knows the
//! correlation in time.
//!
//! Reference: F. X. Diebold, R. S. Mariano, "Comparing predictive accuracy", Journal of Business & Economic Statistics 13(3), 1995.

use nalgebra::{DMatrix, DVector};

use super::evidence::{HeldOutChange, HeldOutData};
use super::restriction::Restriction;
use crate::estimation::linear_fit::LinearFit;
use crate::estimation::{EstimationError, Factorisation, Observation};
use crate::linalg::{BlockWhitening, LeastSquares};
use crate::statistics::t_interval;

/// Parts of the recording of which each in turn is predicted.
const FOLDS: usize = 5;

/// Parts over which the ratios are averaged.
const PARTS: usize = 10;

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
        (weights, fit): (&BlockWhitening, &LeastSquares),
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
        let (mut without, mut with, mut count) = (Vec::new(), Vec::new(), 0);
        for fold in &self.folds {
            let restricted = restriction.restricted(&fold.beta, &fold.inverse)?;
            without.extend(fold.squares(&restricted));
            with.extend(fold.squares(&fold.beta));
            count += fold.equations;
        }
        changed(self.data, [&without, &with], count)
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
    let (mut squares, mut count) = ([Vec::new(), Vec::new()], 0);
    for fold in 0..FOLDS {
        for (squares, observation) in squares.iter_mut().zip([before, after]) {
            let Some(of) = folded(observation, weights, fold) else { return Ok(None) };
            count += of.equations;
            squares.extend(of.squares(&of.beta));
        }
    }
    Ok(changed(HeldOutData::Folds, squares.each_ref().map(Vec::as_slice), count / 2))
}

/// The change of the squared error of each sample, of `count` equations. Parts of a motion are as unlike as its speeds, so that their ratios are
/// compared: an interval of the sums would be that of the largest part.
fn changed(data: HeldOutData, [without, with]: [&[f64]; 2], count: usize) -> Option<HeldOutChange> {
    let samples = without.len();
    let (before, after): (f64, f64) = (without.iter().sum(), with.iter().sum());
    if samples < 2 * PARTS || before <= 0.0 {
        return None;
    }
    let ratios: Vec<f64> = (0..PARTS)
        .map(|part| {
            let range = part * samples / PARTS..(part + 1) * samples / PARTS;
            let [with, without] = [with, without].map(|of| of[range.clone()].iter().sum::<f64>());
            libm::log(with.max(f64::MIN_POSITIVE)) - libm::log(without.max(f64::MIN_POSITIVE))
        })
        .collect();
    let interval = t_interval(&ratios, 0.95)?;
    let rms = |sum: f64| (sum / count.max(1) as f64).sqrt();
    let change_ci95 = [interval.low, interval.high].map(libm::expm1);
    Some(HeldOutChange { data, without: rms(before), with: rms(after), change_ci95 })
}

impl Fold {
    fn of(fit: &LeastSquares, weights: &BlockWhitening, unseen: &Observation) -> Result<Self, EstimationError> {
        let y = DMatrix::from_column_slice(unseen.y.len(), 1, unseen.y.as_slice());
        Ok(Self {
            beta: fit.solution().clone(),
            inverse: fit.inverse_information(),
            h: weights.clone().whiten(&unseen.regressor, &unseen.used)?,
            z: weights.clone().whiten(&y, &unseen.used)?.column(0).into_owned(),
            dof: unseen.dof,
            equations: unseen.equations(),
        })
    }

    /// Squared error of each sample.
    fn squares(&self, beta: &DVector<f64>) -> Vec<f64> {
        let error = &self.z - &self.h * beta;
        error.as_slice().chunks_exact(self.dof).map(|of| of.iter().map(|e| e * e).sum()).collect()
    }
}

/// The fit to all but one fold of consecutive samples; `None` where it does not determine the parameters.
fn folded(observation: &Observation, weights: &BlockWhitening, fold: usize) -> Option<Fold> {
    let (n, samples) = (observation.dof, observation.samples());
    let out = fold * samples / FOLDS * n..(fold + 1) * samples / FOLDS * n;
    let (mut seen, mut unseen) = (observation.clone(), observation.clone());
    for row in 0..n * samples {
        let other = if out.contains(&row) { &mut seen } else { &mut unseen };
        other.used[row] = false;
        other.y[row] = 0.0;
        other.regressor.row_mut(row).fill(0.0);
    }
    let fit = Factorisation::new(&seen).ok()?.weighted(weights).ok()?;
    // Only the fold itself.
    let rows = out.len();
    let unseen = Observation {
        regressor: unseen.regressor.rows(out.start, rows).into_owned(),
        y: unseen.y.rows(out.start, rows).into_owned(),
        used: unseen.used[out].to_vec(),
        ..unseen
    };
    Fold::of(&fit, weights, &unseen).ok()
}
