//! Weighted least squares again and again, each equation weighted by what its last residual says.

use nalgebra::DVector;

use super::loss::Loss;
use super::scale::median_scales;
use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;
use crate::linalg::{LeastSquares, RowFactor};

/// Iterations at most.
const ITERATIONS: usize = 500;

/// Change of the fitted torque, over the torque, at which the iteration has come to rest.
const AT_REST: f64 = 1e-12;

/// The scales of the joints.
pub(super) enum Scales {
    /// By the median of the residuals, anew in each iteration.
    Median,
    /// Found before.
    Fixed(Vec<f64>),
}

/// Where the iteration ended.
#[derive(Clone, Debug)]
pub(in crate::estimation) struct RobustFit {
    pub(in crate::estimation) loss: Loss,
    pub(in crate::estimation) beta: DVector<f64>,
    /// Scale of each joint's residual, n.
    pub(in crate::estimation) scales: Vec<f64>,
    pub(in crate::estimation) termination: Termination,
}

impl RobustFit {
    /// These parameters, with the scales of their residual.
    pub(in crate::estimation) fn at(
        observation: &Observation,
        loss: Loss,
        beta: DVector<f64>,
        termination: Termination,
    ) -> Self {
        let scales = median_scales(observation, &observation.residual(&beta));
        Self { loss, beta, scales, termination }
    }

    /// ω/s² of each equation, n·M; zero in rows that are no equation.
    pub(in crate::estimation) fn weights(&self, observation: &Observation) -> Vec<f64> {
        row_weights(observation, &observation.residual(&self.beta), &self.scales, |u| self.loss.weight(u))
    }

    /// Residuals over their scales, n·M; zero in rows that are no equation.
    pub(in crate::estimation) fn scaled_residual(&self, observation: &Observation) -> DVector<f64> {
        let mut u = observation.residual(&self.beta);
        for (row, u) in u.iter_mut().enumerate() {
            *u /= self.scales[row % observation.dof];
        }
        u
    }
}

/// Iterates from least squares with the joints weighted by the medians of its residuals.
pub(in crate::estimation) fn from_least_squares(
    problem: &EstimationProblem<'_>,
    start: &DVector<f64>,
    loss: Loss,
) -> Result<RobustFit, EstimationError> {
    let observation = problem.observation;
    let scales = median_scales(observation, &observation.residual(start));
    let weights = row_weights(observation, &observation.y, &scales, |_| 1.0);
    let start = weighted_rows(observation, &weights)?.solution().clone();
    iterate(problem, start, loss, Scales::Median)
}

/// Iterates from `beta` (b) until the fitted torque is at rest, or the problem's observer ends it.
pub(super) fn iterate(
    problem: &EstimationProblem<'_>,
    mut beta: DVector<f64>,
    loss: Loss,
    scales: Scales,
) -> Result<RobustFit, EstimationError> {
    let observation = problem.observation;
    let mut residual = observation.residual(&beta);
    let of = |residual: &DVector<f64>| match &scales {
        Scales::Median => median_scales(observation, residual),
        Scales::Fixed(scales) => scales.clone(),
    };
    let mut last_step = f64::INFINITY;
    for iterations in 1..=ITERATIONS {
        let found = of(&residual);
        let weights = row_weights(observation, &residual, &found, |u| loss.weight(u));
        beta = weighted_rows(observation, &weights)?.solution().clone();
        let next = observation.residual(&beta);
        last_step = change(observation, &residual, &next);
        residual = next;
        let at_rest = (last_step <= AT_REST).then_some(Termination::Converged { iterations, last_step });
        if let Some(termination) = at_rest.or_else(|| problem.ended_after(iterations, ITERATIONS)) {
            return Ok(RobustFit { loss, scales: of(&residual), beta, termination });
        }
    }
    let termination = Termination::IterationLimit { iterations: ITERATIONS, last_step };
    Ok(RobustFit { loss, scales: of(&residual), beta, termination })
}

/// The largest change of a joint's fitted torque, over that joint's torque.
fn change(observation: &Observation, before: &DVector<f64>, after: &DVector<f64>) -> f64 {
    let n = observation.dof;
    let of = |i: usize| {
        let (mut moved, mut power) = (0.0, 0.0);
        for row in (i..before.len()).step_by(n) {
            moved += (after[row] - before[row]) * (after[row] - before[row]);
            power += observation.y[row] * observation.y[row];
        }
        if power > 0.0 { (moved / power).sqrt() } else { 0.0 }
    };
    (0..n).map(of).fold(0.0, f64::max)
}

/// `weight(r/s) / s²` of each equation, n·M; zero in rows that are no equation.
pub(super) fn row_weights(
    observation: &Observation,
    residual: &DVector<f64>,
    scales: &[f64],
    weight: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let of = |(row, &used): (usize, &bool)| {
        let s = scales[row % observation.dof];
        if used { weight(residual[row] / s) / (s * s) } else { 0.0 }
    };
    observation.used.iter().enumerate().map(of).collect()
}

/// `min Σ_r weight_r (y_r − w_r β)²`.
pub(in crate::estimation) fn weighted_rows(
    observation: &Observation,
    weights: &[f64],
) -> Result<LeastSquares, EstimationError> {
    let (n, b) = (observation.dof, observation.regressor.ncols());
    let mut factor = RowFactor::new(b + 1);
    // Joint by joint, since a joint's rows begin with the same zeros.
    for i in 0..n {
        let used = (i..weights.len()).step_by(n).filter(|&row| weights[row] > 0.0);
        let rows: Vec<(usize, f64)> = used.map(|row| (row, weights[row].sqrt())).collect();
        factor.add(rows.len(), |k, column| {
            let (row, root) = rows[k];
            root * if column < b { observation.regressor[(row, column)] } else { observation.y[row] }
        });
    }
    LeastSquares::from_triangle(&factor.finish()).map_err(|error| observation.named(error))
}
