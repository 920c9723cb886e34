//! The fit of a model's own terms to a log.

use nalgebra::{DMatrix, DVector};

use super::bodies::Body;
use super::drives::Coefficient;
use super::equations::NormalEquations;
use super::guess::ModelGuess;
use super::minimum::{Divergence, Minimum};
use super::weight::{BLOCKS, PriorWeight, down_to};
use crate::estimation::error::EstimationError;
use crate::estimation::termination::Termination;
use crate::model::{Columns, ParameterId, ParameterKind, Robot, StandardParameters};
use crate::observer::Observer;
use crate::regressor::JointTorqueRegressor;
use crate::signal::Samples;

/// The weight of the guess in the first fit, whose residual weighs the joints of the second.
const FIRST: f64 = 1e-2;

/// A residual below this part of its joint's torque weighs no more: a log without noise is no exact one.
const LEAST_RESIDUAL: f64 = 1e-3;

/// Fits of friction of the load at most, and the change of its coefficients, as a part of the largest, at which it rests.
const ROUNDS: usize = 12;
const REST: f64 = 1e-3;

/// A full set of parameters, zero in all terms that were not asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFit {
    /// The set; every body can be one.
    pub parameters: StandardParameters,
    /// How much the guess counts.
    pub weight: PriorWeight,
    /// 1/σ_j² of each joint, the inverse square of the unit of its torque: how much its equations count.
    pub joint_weights: Vec<f64>,
    /// How the search ended.
    pub termination: Termination,
}

/// Fits the parameters of `columns` to the equations of a log, near a guess. Friction of the load is that of the links of the fit before,
/// from the guess on, until it rests. The observer sees every search for the weight, and may end the fit, which then has no result.
///
/// # Errors
/// [`EstimationError::Count`] where robot, samples and guess are not of the same joints, [`EstimationError::NothingActs`] where there is
/// no equation, [`EstimationError::NotDefinite`] where a body of the guess is none, [`EstimationError::Columns`] where a column depends
/// on what no recording has, [`EstimationError::Interrupted`] where the observer ended it.
pub fn fit_model(
    robot: &Robot,
    columns: Columns,
    samples: &Samples,
    guess: &ModelGuess,
    observer: &dyn Observer,
) -> Result<ModelFit, EstimationError> {
    columns.check_estimable()?;
    let under = |links: &StandardParameters| fit_under(links, robot, columns, samples, guess, observer);
    let mut fit = under(&guess.parameters)?;
    let of_load: Vec<_> = columns.terms().filter(|term| term.entry().needs.load).collect();
    for round in 0..=ROUNDS {
        let coefficients = |fit: &ModelFit| -> Vec<f64> {
            let drives = fit.parameters.drives.iter();
            drives.flat_map(|drive| of_load.iter().map(|&term| drive[term]).collect::<Vec<_>>()).collect()
        };
        if of_load.is_empty() {
            break;
        }
        let next = under(&fit.parameters)?;
        let (before, after) = (coefficients(&fit), coefficients(&next));
        let change = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        fit = next;
        if change <= REST * after.iter().fold(0.0_f64, |most, x| most.max(x.abs())) {
            break;
        }
        if round == ROUNDS {
            fit.termination = Termination::IterationLimit { iterations: ROUNDS, last_step: change };
        }
    }
    Ok(fit)
}

/// The fit with the load that these links give.
fn fit_under(
    links: &StandardParameters,
    robot: &Robot,
    columns: Columns,
    samples: &Samples,
    guess: &ModelGuess,
    observer: &dyn Observer,
) -> Result<ModelFit, EstimationError> {
    let log = LogEquations::of(links, robot, columns, samples, guess)?;
    let scale = |mean: &f64| 1.0 / mean.max(f64::MIN_POSITIVE);
    let torque: Vec<f64> = log.mean_squares(&log.y);
    let first: Vec<f64> = torque.iter().map(scale).collect();
    let all = NormalEquations::sum(&log.blocks(&first));
    let x = log.prior.descend(&all, down_to(FIRST)).x;
    let residual = log.mean_squares(&(&log.y - &log.w * x));
    let floor = LEAST_RESIDUAL * LEAST_RESIDUAL;
    let weights: Vec<f64> =
        residual.iter().zip(&torque).map(|(residual, torque)| scale(&residual.max(floor * torque))).collect();
    let blocks = log.blocks(&weights);
    let weight = PriorWeight::chosen(&blocks, &log.prior, observer)?;
    let Minimum { x, termination } = log.prior.descend(&NormalEquations::sum(&blocks), down_to(weight.taken));
    Ok(ModelFit { parameters: log.parameters(&x, &guess.parameters), weight, joint_weights: weights, termination })
}

/// The equations of a log in the coordinates of a guess.
pub(super) struct LogEquations {
    ids: Vec<ParameterId>,
    /// W X, nM × p; rows that are no equation are zero.
    pub(super) w: DMatrix<f64>,
    /// X, p × p.
    pub(super) scale: DMatrix<f64>,
    pub(super) y: DVector<f64>,
    /// Equations of each joint.
    counts: Vec<f64>,
    pub(super) prior: Divergence,
}

impl LogEquations {
    pub(super) fn of(
        load: &StandardParameters,
        robot: &Robot,
        columns: Columns,
        samples: &Samples,
        guess: &ModelGuess,
    ) -> Result<Self, EstimationError> {
        let n = robot.dof();
        EstimationError::unless_equal("joints of the samples", samples.dof(), n)?;
        EstimationError::unless_equal("links of the guess", guess.parameters.links.len(), n)?;
        let regressor = JointTorqueRegressor::with_load(robot, columns, load);
        let ids = regressor.parameters().to_vec();
        let p = ids.len();
        let mut w = regressor.stack_means(&samples.states, &(0..p).collect::<Vec<_>>(), samples.block);
        let mut y = DVector::from_vec(samples.block_means(&samples.tau, n));
        let mut counts = vec![0.0; n];
        for (row, &used) in samples.used.iter().enumerate() {
            if used {
                counts[row % n] += 1.0;
            } else {
                w.row_mut(row).fill(0.0);
                y[row] = 0.0;
            }
        }
        if counts.iter().all(|&count| count == 0.0) {
            return Err(EstimationError::NothingActs { equations: 0 });
        }
        let (mut bodies, mut coefficients) = (Vec::new(), Vec::new());
        let mut scale = DMatrix::zeros(p, p);
        for (at, &id) in ids.iter().enumerate() {
            if id.kind == ParameterKind::M {
                let body = Body::around(at, &guess.parameters.links[id.index], guess.bounds(id.index))
                    .ok_or(EstimationError::NotDefinite)?;
                scale.fixed_view_mut::<10, 10>(at, at).copy_from(&body.jacobian());
                bodies.push(body);
            }
            let column = w.column(at);
            let torque: f64 = column.iter().zip(&y).map(|(entry, y)| if *entry == 0.0 { 0.0 } else { y * y }).sum();
            if let Some(own) = Coefficient::of(at, id, &guess.parameters, column.norm(), torque.sqrt()) {
                scale[(at, at)] = own.unit;
                coefficients.push(own);
            }
        }
        let w = w * &scale;
        Ok(Self { ids, w, scale, y, counts, prior: Divergence { bodies, coefficients } })
    }

    /// Mean square of each joint's rows over its equations, n.
    fn mean_squares(&self, rows: &DVector<f64>) -> Vec<f64> {
        let n = self.counts.len();
        let mut sums = vec![0.0; n];
        rows.iter().enumerate().for_each(|(row, value)| sums[row % n] += value * value);
        sums.iter().zip(&self.counts).map(|(sum, count)| sum / count.max(1.0)).collect()
    }

    /// The normal equations of so many parts of the log, one after the other, with the weight of each joint.
    pub(super) fn blocks(&self, weights: &[f64]) -> Vec<NormalEquations> {
        let n = weights.len();
        let samples = self.y.len() / n;
        let at = |b: usize| n * (b * samples / BLOCKS);
        (0..BLOCKS).map(|b| NormalEquations::of(&self.w, &self.y, weights, at(b)..at(b + 1))).collect()
    }

    /// The parameters at a point; a coefficient that no row shows stays as it was guessed.
    pub(super) fn parameters(&self, x: &DVector<f64>, guess: &StandardParameters) -> StandardParameters {
        let phi = &self.scale * x;
        let mut parameters = StandardParameters::zero(guess.links.len());
        for (at, &id) in self.ids.iter().enumerate() {
            let shown = id.kind.term().is_none() || self.scale[(at, at)] > 0.0;
            parameters.set(id, if shown { phi[at] } else { guess.get(id) });
        }
        parameters
    }
}
