//! The S-estimate: the fit whose residuals have the smallest M-scale. Its breakdown point is one half.
//!
//! ```text
//! min s(β)        Σ_r ρ(u_r/(1.54764 s)) = ½ (E − b)        u_r = (y_r − w_r β)/s_i        ρ Tukey's, from 0 to 1
//! ```
//! Many minima: the search starts from all guesses of [`doubtful_halves`] at every so many samples, follows the best few by
//! weights, and sorts again among what the best leaves, until the scale falls no more. A minimum that is near none of
//! these starts is missed: no search in reasonable time excludes that.
//!
//! References: P. Rousseeuw, V. Yohai, "Robust regression by means of S-estimators", Lecture Notes in Statistics 26, 1984;
//! M. Salibián-Barrera, V. Yohai, "A fast algorithm for S-regression estimates", Journal of Computational and Graphical
//! Statistics 15(2), 2006.

use nalgebra::DVector;

use super::components::doubtful_halves;
use super::iteration::{row_weights, weighted_rows};
use super::loss::biweight;
use super::scale::{S_CONSTANT, least_scales, m_scale, median_scales};
use crate::estimation::error::EstimationError;
use crate::estimation::observation::Observation;
use crate::estimation::problem::EstimationProblem;
use crate::estimation::termination::Termination;

/// Equations that starts are compared on, and at least this many for each parameter.
const START_EQUATIONS: usize = 1500;
const PER_PARAMETER: usize = 10;
/// Starts that are followed to their minimum.
const FOLLOWED: usize = 5;
/// Rounds of sorting.
const ROUNDS: usize = 4;
/// Scales beyond which an equation takes no part in the next round.
const DOUBTFUL: f64 = 2.5;
/// Weighted fits towards one minimum.
const STEPS: usize = 1000;
/// Relative fall of the scale at which a minimum is reached.
const AT_REST: f64 = 1e-13;

/// The S-estimate.
pub(super) struct Start {
    pub(super) beta: DVector<f64>,
    pub(super) termination: Termination,
}

/// Searches from the ordinary solution (b).
pub(super) fn search(problem: &EstimationProblem<'_>, ordinary: &DVector<f64>) -> Result<Start, EstimationError> {
    let observation = problem.observation;
    let scales = median_scales(observation, &observation.residual(ordinary));
    let all = row_weights(observation, &observation.y, &scales, |_| 1.0);
    // Every so many samples, of all joints.
    let wanted = START_EQUATIONS.max(PER_PARAMETER * observation.regressor.ncols());
    let stride = (observation.equations() / wanted).max(1);
    let is_taken = |row: usize| (row / observation.dof).is_multiple_of(stride);
    let few: Vec<f64> = all.iter().enumerate().map(|(row, &w)| if is_taken(row) { w } else { 0.0 }).collect();
    let first = weighted_rows(observation, &all)?;
    let mut best = minimum(observation, first.solution().clone(), &all, &scales)?;
    for rounds in 0..ROUNDS {
        let residual = observation.residual(&best.beta);
        let kept: Vec<f64> = (0..few.len())
            .map(|row| if residual[row].abs() * few[row].sqrt() <= DOUBTFUL * best.scale { few[row] } else { 0.0 })
            .collect();
        let Some(better) = round(problem, &few, &kept, &all, &scales)? else { break };
        let interrupted = problem.ended_after(rounds, ROUNDS);
        if better.scale >= best.scale * (1.0 - AT_REST) {
            break;
        }
        best = better;
        if let Some(termination) = interrupted {
            best.termination = termination;
            break;
        }
    }
    Ok(Start { beta: best.beta, termination: best.termination })
}

/// The best minimum from the starts that the equations with a weight in `kept` give.
fn round(
    problem: &EstimationProblem<'_>,
    few: &[f64],
    kept: &[f64],
    all: &[f64],
    scales: &[f64],
) -> Result<Option<Minimum>, EstimationError> {
    let observation = problem.observation;
    let Ok(fit) = weighted_rows(observation, kept) else { return Ok(None) };
    let rows: Vec<usize> = (0..kept.len()).filter(|&row| kept[row] > 0.0).collect();
    let mut starts = vec![(scale(observation, fit.solution(), few), fit.solution().clone())];
    let halves = doubtful_halves(observation, &rows, few, &fit)?;
    let total = halves.len();
    for (done, half) in halves.into_iter().enumerate() {
        let mut weights = kept.to_vec();
        for row in half {
            weights[row] = 0.0;
        }
        if problem.ended_after(done, total).is_some() {
            break;
        }
        // A half that does not show every parameter is no start.
        if let Ok(fit) = weighted_rows(observation, &weights) {
            let beta = fit.solution().clone();
            starts.push((scale(observation, &beta, few), beta));
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<Minimum> = None;
    for (_, beta) in starts.into_iter().take(FOLLOWED) {
        let here = minimum(observation, beta, all, scales)?;
        if best.as_ref().is_none_or(|best| here.scale < best.scale) {
            best = Some(here);
        }
    }
    Ok(best)
}

struct Minimum {
    beta: DVector<f64>,
    scale: f64,
    termination: Termination,
}

/// Weighted fits from `beta` until the scale rests.
fn minimum(
    observation: &Observation,
    mut beta: DVector<f64>,
    all: &[f64],
    scales: &[f64],
) -> Result<Minimum, EstimationError> {
    let least = least_scales(observation).iter().zip(scales).map(|(least, s)| least / s).fold(f64::INFINITY, f64::min);
    let mut found = scale(observation, &beta, all).max(least);
    let mut last_step = f64::INFINITY;
    for iterations in 1..=STEPS {
        let residual = observation.residual(&beta);
        let weights: Vec<f64> = all
            .iter()
            .enumerate()
            .map(|(row, &w)| if w > 0.0 { w * biweight(residual[row] * w.sqrt() / (S_CONSTANT * found)) } else { 0.0 })
            .collect();
        // The good half of a guess need not show every parameter.
        let Ok(fit) = weighted_rows(observation, &weights) else {
            return Ok(Minimum { beta, scale: found, termination: Termination::Singular { iterations } });
        };
        let next = scale(observation, fit.solution(), all).max(least);
        last_step = (next / found - 1.0).abs();
        if next <= found {
            beta = fit.solution().clone();
            found = next;
        }
        if last_step <= AT_REST || next > found {
            let termination = Termination::Converged { iterations, last_step };
            return Ok(Minimum { beta, scale: found, termination });
        }
    }
    Ok(Minimum { beta, scale: found, termination: Termination::IterationLimit { iterations: STEPS, last_step } })
}

/// The M-scale of the weighted residuals.
fn scale(observation: &Observation, beta: &DVector<f64>, weights: &[f64]) -> f64 {
    let residual = observation.residual(beta);
    let rows = weights.iter().enumerate().filter(|(_, w)| **w > 0.0);
    let r: Vec<f64> = rows.map(|(row, &w)| residual[row].abs() * w.sqrt()).collect();
    let freedom = r.len() as f64 - beta.len() as f64;
    m_scale(&r, freedom.max(1.0))
}
